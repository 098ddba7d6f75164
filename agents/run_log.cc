#include "agents/run_log.h"

#include <spdlog/fmt/ranges.h>

#include <array>
#include <charconv>
#include <fstream>
#include <sstream>

#include "data/base/atomic_file.h"
#include "data/base/error.h"
#include "data/picture.h"

namespace sandwright {
namespace {

// Columns of progress.csv, fixed so that runs compare; a value that an update lacks stays empty.
constexpr std::array kColumns = {"rollout/ep_rew_mean",
                                 "rollout/ep_len_mean",
                                 "rollout/success_rate",
                                 "rollout/in_goal_mean_diff_start_mm",
                                 "rollout/in_goal_mean_diff_mm",
                                 "rollout/rejected_strokes",
                                 "eval/in_goal_mean_diff_start_mm",
                                 "eval/in_goal_mean_diff_mm",
                                 "eval/success_rate",
                                 "eval/mean_reward",
                                 "train/drawn_reward",
                                 "train/best_reward",
                                 "train/policy_loss",
                                 "train/value_loss",
                                 "train/entropy",
                                 "train/critic_loss",
                                 "train/actor_loss",
                                 "train/ent_coef",
                                 "train/approx_kl",
                                 "train/clip_fraction",
                                 "train/explained_variance",
                                 "train/advantage_deviation",
                                 "train/return_deviation",
                                 "train/gradient_norm",
                                 "train/learning_rate",
                                 "train/epochs",
                                 "time/fps",
                                 "time/rollout_s",
                                 "time/update_s"};

}  // namespace

RunLog::RunLog(const std::filesystem::path& folder, int64_t first_step)
    : csv_(folder / "progress.csv"), tensorboard_(folder) {
  std::string kept = fmt::format("time/total_timesteps,{}\n", fmt::join(kColumns, ","));
  if (first_step > 0 && std::filesystem::exists(csv_)) {
    std::istringstream rows(ReadFile(csv_));
    std::string row;
    std::getline(rows, row);  // the header
    while (std::getline(rows, row)) {
      int64_t step = 0;
      std::from_chars(row.data(), row.data() + row.size(), step);
      if (step <= first_step) kept += row + "\n";
    }
  }
  WriteFileAtomically(csv_, kept);
}

void RunLog::Write(int64_t step, const std::map<std::string, double>& scalars) {
  std::string row = fmt::format("{}", step);
  for (const char* column : kColumns) {
    const auto found = scalars.find(column);
    row += found == scalars.end() ? "," : fmt::format(",{:.6g}", found->second);
  }
  std::ofstream out(csv_, std::ios::app);
  out << row << "\n" << std::flush;
  if (!out) throw Error("cannot write " + csv_.string());
  const std::vector<std::pair<std::string, double>> pairs(scalars.begin(), scalars.end());
  tensorboard_.Write(step, pairs);
}

void RunLog::WritePicture(int64_t step, const std::string& tag, const cv::Mat& bgr) {
  tensorboard_.WritePicture(step, tag, bgr.cols, bgr.rows, EncodePng(bgr));
}

}  // namespace sandwright
