// The controller fake as a program, for trials by hand: `sandwright deploy --arm 127.0.0.1` against
// it in another terminal, faults by commands on its standard input.
#include <CLI/CLI.hpp>
#include <functional>
#include <iostream>
#include <map>
#include <sstream>
#include <thread>

#include "data/base/error.h"
#include "tests/support/controller_fake/controller_fake.h"

namespace sandwright {
namespace {

using Words = std::istringstream;
using Command = std::function<void(ControllerFake&, Words&)>;

double Number(Words& words, double otherwise) {
  double number = 0;
  return words >> number ? number : otherwise;
}

bool On(Words& words) {
  std::string word;
  return !(words >> word) || word != "off";
}

void PrintStatus(ControllerFake& fake) {
  const fake::ControllerState state = fake.state();
  std::cout << "robot mode " << static_cast<int>(state.robot_mode) << ", safety mode "
            << static_cast<int>(state.safety_mode) << ", runtime "
            << static_cast<int>(state.runtime) << ", program '" << state.program << "', slider "
            << state.speed_slider << ", joints " << state.q.rad.transpose() << std::endl;
}

// Writes time and joints of the program, a line each 8 ms.
void PrintTrace(ControllerFake& fake) {
  const auto digits = std::cout.precision(12);
  for (const fake::TracePoint& point : fake.trace()) {
    std::cout << "trace " << point.time_s;
    for (int i = 0; i < 6; ++i) std::cout << ' ' << point.q[i];
    std::cout << '\n';
  }
  std::cout << "trace end" << std::endl;
  std::cout.precision(digits);
}

void PrintLists(ControllerFake& fake) {
  for (const std::string& script : fake.scripts()) std::cout << script << "----\n";
  for (const std::string& message : fake.messages()) std::cout << "textmsg " << message << '\n';
  if (const auto fault = fake.last_fault())
    std::cout << "fault " << fault->line << ':' << fault->column << ' ' << fault->text << '\n';
  std::cout << "scripts end" << std::endl;
}

const std::map<std::string, Command>& Commands() {
  static const std::map<std::string, Command> commands = {
      {"status", [](auto& f, auto&) { PrintStatus(f); }},
      {"trace", [](auto& f, auto&) { PrintTrace(f); }},
      {"scripts", [](auto& f, auto&) { PrintLists(f); }},
      {"slider", [](auto& f, auto& w) { f.SetSlider(Number(w, 1)); }},
      {"pause", [](auto& f, auto&) { f.PausePendant(); }},
      {"play", [](auto& f, auto&) { f.ResumePendant(); }},
      {"stop", [](auto& f, auto&) { f.StopPendant(); }},
      {"popup", [](auto& f, auto& w) { f.AnswerPopup(On(w)); }},
      {"foreign", [](auto& f, auto&) { f.StartForeignProgram(); }},
      {"safeguard", [](auto& f, auto& w) { f.SafeguardStop(On(w)); }},
      {"estop", [](auto& f, auto& w) { f.EmergencyStop(On(w)); }},
      {"protect", [](auto& f, auto&) { f.ProtectiveStop(); }},
      {"force",
       [](auto& f, auto& w) {
         const double newton = Number(w, 60);
         f.ForceSpike(newton, Number(w, 0.5));
       }},
      {"reject", [](auto& f, auto& w) { f.RejectScripts(On(w)); }},
      {"swallow", [](auto& f, auto& w) { f.SwallowKeyMessages(On(w)); }},
      {"delay", [](auto& f, auto& w) { f.DelayKeyMessages(Number(w, 1)); }},
      {"stall", [](auto& f, auto& w) { f.StallRtde(Number(w, 1)); }},
      {"fin", [](auto& f, auto&) { f.CloseConnections(false); }},
      {"rst", [](auto& f, auto&) { f.CloseConnections(true); }},
      {"split", [](auto& f, auto& w) { f.SplitBytes(On(w)); }},
      {"coalesce", [](auto& f, auto& w) { f.CoalesceFrames(On(w)); }},
  };
  return commands;
}

void ReadCommands(ControllerFake& fake) {
  std::string line, word;
  while (std::getline(std::cin, line)) {
    Words words(line);
    if (!(words >> word)) continue;
    if (word == "quit") return;
    const auto found = Commands().find(word);
    if (found != Commands().end()) {
      found->second(fake, words);
      continue;
    }
    std::cout << "commands: quit";
    for (const auto& [name, command] : Commands()) std::cout << ' ' << name;
    std::cout << std::endl;
  }
}

int Main(int argc, char** argv) {
  ControllerFakeOptions options;
  options.ports = ControllerPorts::Standard();
  bool keep = false, off = false, lenient = false;
  CLI::App app("A stand-in for a UR10 CB3 controller.");
  app.add_option("--address", options.address, "to listen on");
  app.add_option("--dashboard", options.ports.dashboard, "port; 0: any");
  app.add_option("--primary", options.ports.primary, "port; 0: any");
  app.add_option("--secondary", options.ports.secondary, "port; 0: any");
  app.add_option("--realtime", options.ports.realtime, "port; 0: any");
  app.add_option("--rtde", options.ports.rtde, "port; 0: any");
  app.add_option("--time-factor", options.time_factor, "controller seconds a second")
      ->check(CLI::Range(0.01, 100.0));
  app.add_flag("--off", off, "start with the arm powered off");
  app.add_flag("--lenient", lenient, "take scripts that break the manual's rules of layout");
  app.add_flag("--keep", keep, "go on when the standard input ends");
  CLI11_PARSE(app, argc, argv);
  options.powered = !off;
  options.strict_scripts = !lenient;

  ControllerFake fake(options);
  const ControllerPorts& ports = fake.ports();
  std::cout << "controller fake on " << options.address << ": dashboard " << ports.dashboard
            << ", primary " << ports.primary << ", secondary " << ports.secondary << ", realtime "
            << ports.realtime << ", rtde " << ports.rtde << std::endl;
  ReadCommands(fake);
  while (keep && std::cin.eof()) std::this_thread::sleep_for(std::chrono::seconds(1));
  return 0;
}

}  // namespace
}  // namespace sandwright

int main(int argc, char** argv) {
  try {
    return sandwright::Main(argc, argv);
  } catch (const sandwright::Error& error) {
    std::cerr << error.what() << '\n';
    return 2;
  }
}
