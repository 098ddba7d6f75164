// sandwright demo: from a depth frame to executed and checked strokes, with a report to look at.
#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <filesystem>

#include "cli/command.h"
#include "cli/demo_report.h"
#include "cli/demo_run.h"
#include "data/base/atomic_file.h"
#include "data/shipped.h"

namespace sandwright {
namespace {

class DemoCommand final : public Command {
 public:
  void Declare(CLI::App& app) override {
    app.add_option("--depth", depth_,
                   "depth frame of a levelled sand box (default: the shipped one)");
    app.add_option("--out", out_,
                   "folder for report.html, demo.json, strokes.script and what they were made of")
        ->capture_default_str();
  }
  void Fields(FieldList& f) override { config_.Fields(f); }

  int Run() override {
    std::error_code failed;
    std::filesystem::create_directories(out_, failed);
    if (failed) throw Error("cannot write " + out_ + ": " + failed.message());
    const std::string frame =
        depth_.empty() ? ShippedFile("samples/demo_depth.png").string() : depth_;
    const DemoReport report = RunDemo(frame, config_, seed(), threads());
    const std::filesystem::path folder = out_;
    WriteHeightMap(report.terrain, folder / "terrain.h5");
    WriteHeightMap(report.goal, folder / "goal.h5");
    WriteFileAtomically(folder / "workcell.yaml", CellText(report.cell));
    WritePlan(report.plan, folder / "plan.yaml");
    if (report.urscript.empty()) {
      std::filesystem::remove(folder / "strokes.script");  // another run's would lie here unseen
    } else {
      WriteFileAtomically(folder / "strokes.script", report.urscript);
    }
    WriteFileAtomically(folder / "report.html", RenderDemoReport(report));
    const nlohmann::json json = DemoJson(report);
    WriteFileAtomically(folder / "demo.json", WithRun(json).dump(2) + "\n");
    WriteResult(json);
    const ShapingRun& run = report.runs.front().run;
    fmt::print("goal error {:.2f} -> {:.2f} mm in {} strokes ({} rejected) by {}; look at {}\n",
               1e3 * run.start_error_m, 1e3 * run.final_error_m(), run.strokes.size(),
               run.rejected(), report.runs.front().agent, (folder / "report.html").string());
    return report.stopped ? 130 : 0;
  }

 private:
  static std::string CellText(Workcell cell) { return ToYaml(FieldsOf(cell)); }

  std::string depth_, out_ = "demo_out";
  DemoConfig config_;
};

}  // namespace

std::unique_ptr<Command> MakeDemoCommand() { return std::make_unique<DemoCommand>(); }

}  // namespace sandwright
