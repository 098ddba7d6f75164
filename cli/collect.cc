// sandwright collect: random strokes executed one after another, before and after kept.
#include "env/collect.h"

#include <spdlog/fmt/fmt.h>

#include "cli/collect_on_rig.h"
#include "cli/command.h"
#include "data/base/error.h"

namespace sandwright {
namespace {

class CollectCommand final : public Command {
 public:
  void Declare(CLI::App& app) override {
    app.add_option("--source", request_.source,
                   "who moves the sand: heightfield, dem (grains, needs LAMMPS), or an arm, simulated "
                   "or real (rig), that looks at it before and after")
        ->check(CLI::IsMember({"heightfield", "dem", "simulated", "rig"}))
        ->capture_default_str();
    app.add_option("--strokes", request_.strokes, "strokes in all, with those that exist")
        ->required();
    app.add_option("--sequence", request_.sequence,
                   "strokes a bed (default: 10 with a folder, all with a file)");
    app.add_option("--out", out_,
                   "folder (one file a bed; of an arm: its log) or one .h5 file; what exists is "
                   "continued")
        ->required();
    app.add_option("--arm", rig_request_.arm, "controller's address, for --source rig");
    app.add_flag("--armed", rig_request_.armed, "allow another address than loopback");
    app.add_option("--workcell", rig_request_.workcell, "workcell of an arm (default: the shipped one)");
    app.add_option("--world", rig_request_.world, "sand model under a simulated arm")
        ->capture_default_str();
  }
  void Fields(FieldList& f) override {
    config_.Fields(f);
    f.Section("deployment", deployment_);
    f.Section("controller", controller_);
    f.Section("rig", rig_);
    UnattendedFields(f);
  }

  int Run() override {
    request_.out = out_;
    if (request_.sequence == 0)
      request_.sequence = request_.out.extension() == ".h5" ? request_.strokes : 10;
    request_.seed = seed();
    request_.threads = threads();
    if (request_.out.extension() != ".h5") request_.status = WatchFolder(out_);
    if (request_.source == "simulated" || request_.source == "rig") return OnRig();
    const Collected collected = Collect(config_, request_);
    Say(fmt::format("{} strokes in {}, {} of them new", collected.strokes, out_, collected.added));
    ThrowIfStopRequested();
    WriteResult({{"source", request_.source},
                 {"strokes", collected.strokes},
                 {"strokes_added", collected.added},
                 {"sequence", request_.sequence},
                 {"out", out_}});
    return 0;
  }

 private:
  int OnRig() {
    if (request_.source == "rig" && rig_request_.arm == "simulated")
      throw Error("--source rig needs --arm HOST");
    rig_request_.max_strokes = static_cast<int>(request_.strokes);
    rig_request_.log = out_;
    rig_request_.seed = seed();
    rig_request_.threads = threads();
    DeploySettings settings;
    settings.deployment = deployment_;
    settings.controller = controller_;
    settings.rig = rig_;
    const Deployment done = CollectOnRig(rig_request_, settings, config_, request_.status);
    Say(fmt::format("{}: {} new strokes in {}", done.Outcome(), done.strokes.size(), out_));
    ThrowIfStopRequested();
    WriteResult(ToJson(done));
    return done.ok ? 0 : 3;
  }

  CollectConfig config_;
  DeployRequest rig_request_;
  DeploymentConfig deployment_;
  ControllerPortSettings controller_;
  SimulatedRigConfig rig_;
  CollectRequest request_;
  std::string out_;
};

}  // namespace

std::unique_ptr<Command> MakeCollectCommand() { return std::make_unique<CollectCommand>(); }

}  // namespace sandwright
