// Figures of the controller's client against the fake controller on this machine, as JSON:
//
//   controller_figures ROUNDS > controller.json
//
// How regularly frames come in, and how long it takes from a fault until the program has been stopped.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <iostream>
#include <thread>

#include "data/base/error.h"
#include "data/base/machine.h"
#include "robot_model/controller/ur_controller.h"
#include "robot_model/safety_gate.h"
#include "tests/support/controller_fake/controller_fake.h"

namespace sandwright {
namespace {

using Clock = std::chrono::steady_clock;

double Ms(Clock::duration duration) {
  return std::chrono::duration<double, std::milli>(duration).count();
}

nlohmann::json Spread(std::vector<double> values) {
  std::ranges::sort(values);
  const auto at = [&](double share) {
    return values[static_cast<size_t>(share * static_cast<double>(values.size() - 1))];
  };
  return {{"p50", at(0.5)}, {"p99", at(0.99)}, {"max", values.back()}, {"count", values.size()}};
}

class Bench {
 public:
  // Milliseconds from the fault to the end of the program on the controller, over some rounds.
  nlohmann::json Stop(int rounds, RunEnd expected,
                      const std::function<void(ControllerFake&, UrController&)>& fault) {
    std::vector<double> ms;
    int as_promised = 0;
    for (int round = 0; round < rounds; ++round) {
      ControllerFake fake;
      UrController controller({"127.0.0.1", fake.ports().dashboard, fake.ports().primary,
                               fake.ports().rtde},
                              cell_);
      std::atomic<bool> moving = false;
      std::thread actor([&] {
        while (!moving) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        const auto start = Clock::now();
        fault(fake, controller);
        while (fake.ProgramRunning()) std::this_thread::sleep_for(std::chrono::microseconds(200));
        ms.push_back(Ms(Clock::now() - start));
      });
      const RunOutcome outcome = controller.Run(
          ToCamera(), [&](const RunSample& sample) { moving = moving || sample.knot > 40; });
      moving = true;
      actor.join();
      as_promised += outcome.end == expected;
    }
    nlohmann::json row = Spread(ms);
    row["ended_as_promised"] = as_promised;
    return row;
  }

  // Between frames as they come in during whole runs.
  nlohmann::json Jitter(int rounds) {
    std::vector<double> ms;
    for (int round = 0; round < rounds; ++round) {
      ControllerFake fake;
      UrController controller({"127.0.0.1", fake.ports().dashboard, fake.ports().primary,
                               fake.ports().rtde},
                              cell_);
      std::optional<Clock::time_point> last;
      controller.Run(ToCamera(), [&](const RunSample&) {
        const auto now = Clock::now();
        if (last) ms.push_back(Ms(now - *last));
        last = now;
      });
    }
    return Spread(ms);
  }

 private:
  ArmProgram ToCamera() const {
    const HeightMap bed(80, 120, 0.01, 0.05f);
    return MakeArmProgram(*gate_.PassTransfer(cell_.camera_pose(), bed, cell_.home()).motion, gate_,
                          "to_camera");
  }

  Workcell cell_;
  SafetyGate gate_{cell_};
};

}  // namespace

int Main(int argc, char** argv) {
  if (argc != 2) throw Error("usage: controller_figures ROUNDS");
  const int rounds = std::stoi(argv[1]);
  Bench bench;
  const nlohmann::json result = {
      {"command", fmt::format("controller_figures {}", rounds)},
      {"machine", MachineDescription()},
      {"frame_interval_ms", bench.Jitter(rounds)},
      {"stopped_after_ms",
       {{"operator", bench.Stop(rounds, RunEnd::kStoppedByOperator,
                                [](ControllerFake&, UrController& c) { c.Stop(); })},
        {"force above the limit", bench.Stop(rounds, RunEnd::kForce,
                                             [](ControllerFake& f, UrController&) {
                                               f.ForceSpike(200, 0.2);
                                             })},
        {"no news for 100 ms", bench.Stop(rounds, RunEnd::kLinkLost,
                                          [](ControllerFake& f, UrController&) { f.StallRtde(3); })},
        {"safeguard stop", bench.Stop(rounds, RunEnd::kSafeguardStop,
                                      [](ControllerFake& f, UrController&) {
                                        f.SafeguardStop(true);
                                      })}}}};
  std::cout << result.dump(2) << "\n";
  return 0;
}

}  // namespace sandwright

int main(int argc, char** argv) {
  try {
    return sandwright::Main(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 2;
  }
}
