// The program: finds the subcommand, resolves its configuration, turns errors into exit codes.
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <filesystem>
#include <iostream>
#include <regex>

#include "cli/command.h"
#include "data/base/error.h"
#include "data/base/machine.h"
#include "data/base/stop.h"

namespace sandwright {
namespace {

struct Entry {
  const char* name;
  const char* help;
  std::unique_ptr<Command> (*make)();
};

constexpr Entry kCommands[] = {
    {"scan", "depth frames or a height array -> height map in the box frame, or a refusal",
     MakeScanCommand},
    {"collect", "collects strokes: random ones, one after another, before and after kept",
     MakeCollectCommand},
    {"fit", "trains a surrogate on stroke files", MakeFitCommand},
    {"score", "accuracy of a sand model on stroke files", MakeScoreCommand},
    {"promote", "puts a rig's own sand model in the place of the old one, if it is provably better",
     MakePromoteCommand},
    {"simulate", "applies strokes to a terrain", MakeSimulateCommand},
    {"train", "trains an agent headless", MakeTrainCommand},
    {"eval", "an agent on tasks", MakeEvalCommand},
    {"tasks", "makes task files", MakeTasksCommand},
    {"goal", "a goal from a picture, mesh, drawing or scan, and what the sand can make of it", MakeGoalCommand},
    {"plot", "learning curves of training runs", MakePlotCommand},
    {"plan", "terrain + goal -> gated strokes", MakePlanCommand},
    {"calibrate kinematics", "the arm's factory calibration", MakeCalibrateKinematicsCommand},
    {"calibrate hand-eye", "where the camera is on the flange", MakeCalibrateHandEyeCommand},
    {"calibrate tool", "where the blade is on the flange", MakeCalibrateToolCommand},
    {"calibrate box", "where the box stands", MakeCalibrateBoxCommand},
    {"workcell", "a cell in figures, and as a picture", MakeWorkcellCommand},
    {"check", "the safety gate alone, on a plan", MakeCheckCommand},
    {"export", "plan -> URScript, through the gate", MakeExportCommand},
    {"deploy", "runs strokes on a rig: gate, motion, rescan, compare, next or stop",
     MakeDeployCommand},
    {"convert", "maps and strokes to and from the files of other programs", MakeConvertCommand},
    {"bench", "speed, and speed against error", MakeBenchCommand},
    {"demo", "from a depth frame to strokes on the simulated arm, with a report to look at",
     MakeDemoCommand},
};

// The parser of an entry; "calibrate box" is a subcommand of a subcommand.
CLI::App* AddSubcommand(CLI::App& app, const Entry& entry) {
  const std::string name = entry.name;
  const size_t space = name.find(' ');
  if (space == std::string::npos) return app.add_subcommand(name, entry.help);
  const auto groups = app.get_subcommands(
      [&](const CLI::App* other) { return other->get_name() == name.substr(0, space); });
  CLI::App* group = groups.empty()
                        ? app.add_subcommand(name.substr(0, space), "measures parts of a cell")
                        : groups.front();
  group->require_subcommand(1);
  return group->add_subcommand(name.substr(space + 1), entry.help);
}

// Dotted overrides (key=value) may stand anywhere that is not the value right behind a flag; taken
// out first, so that flags with many values do not swallow them.
std::vector<std::string> TakeOverrides(std::vector<std::string>& arguments) {
  static const std::regex form(R"([a-z_][a-z0-9_]*(\.[a-z0-9_]+)*=.*)");
  std::vector<std::string> overrides, rest;
  for (size_t i = 0; i < arguments.size(); ++i) {
    const bool behind_flag = i > 0 && arguments[i - 1].starts_with("--") &&
                             arguments[i - 1].find('=') == std::string::npos;
    (std::regex_match(arguments[i], form) && !behind_flag ? overrides : rest)
        .push_back(arguments[i]);
  }
  arguments = std::move(rest);
  return overrides;
}

int ExitCode(const Error& error) {
  switch (error.kind()) {
    case ErrorKind::kBadInput: return 2;
    case ErrorKind::kRefused: return 3;
    case ErrorKind::kInterrupted: return 130;
    case ErrorKind::kInternal: return 1;
  }
  return 1;
}

int RunToEnd(Command& command, const std::vector<std::string>& overrides) {
  int code = 1;
  std::string fault;
  try {
    command.Configure(overrides);
    code = command.Run();
  } catch (const Error& e) {
    fault = e.what();
    if (e.kind() == ErrorKind::kRefused) command.WriteRefusal(e.reasons());
    code = ExitCode(e);
  } catch (const std::filesystem::filesystem_error& e) {
    fault = e.what();  // names the file or folder and what the system said
    code = 2;
  } catch (const std::exception& e) {
    fault = std::string("internal fault: ") + e.what();
  }
  if (!fault.empty()) spdlog::error("{}", fault);
  command.Finish(code, fault);
  return code;
}

int Main(int argc, char** argv) {
  // Results go to stdout; everything about the run goes to stderr.
  spdlog::set_default_logger(spdlog::stderr_color_mt("sandwright"));
  spdlog::set_pattern("%^%l%$: %v");
  InstallStopHandler();

  CLI::App app("Sandwright: reinforcement learning for robotic sand shaping", "sandwright");
  app.set_version_flag("--version", BuildVersion() + " (" + BuildCommit() + ")");
  app.require_subcommand(1);
  std::vector<std::pair<CLI::App*, std::unique_ptr<Command>>> commands;
  for (const Entry& entry : kCommands) {
    CLI::App* sub = AddSubcommand(app, entry);
    commands.emplace_back(sub, entry.make());
    commands.back().second->Declare(*sub);
    commands.back().second->DeclareCommon(*sub);
  }

  std::vector<std::string> arguments(argv + 1, argv + argc);
  const std::vector<std::string> overrides = TakeOverrides(arguments);
  std::reverse(arguments.begin(), arguments.end());  // CLI11 takes them last first
  try {
    app.parse(arguments);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }

  for (auto& [sub, command] : commands) {
    if (!sub->parsed()) continue;
    return RunToEnd(*command, overrides);
  }
  return 2;
}

}  // namespace
}  // namespace sandwright

int main(int argc, char** argv) { return sandwright::Main(argc, argv); }
