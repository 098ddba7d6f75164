// sandwright train: learns to shape sand, or a reference task, headless, into a run folder.
#include "agents/join_ranks.h"
#include "agents/train.h"

#include <spdlog/fmt/fmt.h>

#include <filesystem>

#include "cli/command.h"

namespace sandwright {
namespace {

class TrainCommand final : public Command {
 public:
  void Declare(CLI::App& app) override {
    auto* out =
        app.add_option("--out", out_, "run folder to make; a folder with a run in it is refused");
    auto* resume = app.add_option(
        "--resume", resume_,
        "run folder to continue from its last checkpoint, with its configuration and seed; "
        "overrides (key=value) apply on top");
    out->excludes(resume);
  }
  void Fields(FieldList& f) override { config_.Fields(f), UnattendedFields(f); }

  std::string DefaultConfigFile() const override {
    return resume_.empty() ? "" : (std::filesystem::path(resume_) / "config.yaml").string();
  }

  int Run() override {
    if (out_.empty() == resume_.empty()) throw Error("train needs --out RUNDIR or --resume RUNDIR");
    if (!resume_.empty() && !config_file().empty())
      throw Error(
          "--resume takes the run's own configuration; change keys with key=value, not --config");
    const auto ranks = JoinRanks(config_.lost_rank_after_s);
    if (!ranks->leads()) LeaveItToAnother();
    AllOrNone(*ranks, [&] {
      if (ranks->leads() && !out_.empty() &&
          std::filesystem::exists(std::filesystem::path(out_) / "config.yaml"))
        throw Error(fmt::format(
            "--out {}: there is a run already; continue it with --resume, or name another folder",
            out_));
    });
    const std::string folder = out_.empty() ? resume_ : out_;
    const auto result = Train(config_, {.folder = folder,
                                        .seed = seed(),
                                        .threads = threads(),
                                        .resume = !resume_.empty(),
                                        .status = ranks->leads() ? WatchFolder(folder) : nullptr,
                                        .ranks = ranks.get()});
    ranks->Leave();
    Say(fmt::format("{} {} in {:.0f} s{}: {}", result["steps"].get<int64_t>(),
                    config_.OnSand() ? "strokes" : "steps", result["seconds"].get<double>(),
                    Outcome(result), folder));
    WriteResult(result);
    return 0;
  }

 private:
  // What the last evaluation said; a run that had been complete before has none.
  std::string Outcome(const nlohmann::json& result) const {
    const auto number = [&](const char* key) { return result.at(key).get<double>(); };
    if (result.contains("mean_reward"))
      return fmt::format(", mean return {:.1f} +- {:.1f} over {} unseen episodes (best {:.1f})",
                         number("mean_reward"), number("std_reward"), config_.evaluation_tasks,
                         number("mean_reward_best"));
    if (!result.contains("validation_in_goal_mean_diff_mm")) return "";
    return fmt::format(", goal error {:.2f} -> {:.2f} mm on {} unseen tasks (best {:.2f})",
                       number("validation_in_goal_mean_diff_start_mm"),
                       number("validation_in_goal_mean_diff_mm"), config_.evaluation_tasks,
                       number("validation_in_goal_mean_diff_best_mm"));
  }

  TrainConfig config_;
  std::string out_, resume_;
};

}  // namespace

std::unique_ptr<Command> MakeTrainCommand() { return std::make_unique<TrainCommand>(); }

}  // namespace sandwright
