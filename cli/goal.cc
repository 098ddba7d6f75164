// sandwright goal: a goal from what a designer has, and what the sand can make of it.
#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <cmath>

#include "cli/command.h"
#include "cli/goal_request.h"
#include "data/picture.h"
#include "env/feasible_goal.h"
#include "env/goal_picture.h"
#include "env/load_gate.h"

namespace sandwright {
namespace {

class GoalCommand final : public Command {
 public:
  void Declare(CLI::App& app) override {
    app.add_option("--image", request_.image, "grey picture; with --range-mm");
    app.add_option("--range-mm", request_.range_mm, "heights of its black and of its white [mm]")->expected(2);
    app.add_option("--mesh", request_.mesh, "or: .stl, .obj or .ply, seen from above; with --unit");
    app.add_option("--unit", request_.unit, "of a mesh, or of a drawing that names none: mm or m");
    app.add_option("--up", request_.up, "the mesh's axis that points up: x, y, z (default), -x, -y, -z");
    app.add_option("--svg", request_.svg, "or: drawing; data-depth-mm of its elements, or --depth-mm, digs");
    app.add_option("--depth-mm", request_.depth_mm, "depth of its elements that name none [mm]; negative: ridges");
    app.add_option("--scan", request_.scan, "or: height map file; the shape to repeat, an earlier scan to undo");
    app.add_option("--shape", request_.shape, "or: level, mound, crater, trench, ridge or terrace");
    app.add_option("--rise-mm", request_.rise_mm, "its height or depth [mm]")->check(CLI::Range(0.0, 500.0));
    app.add_option("--flat-mm", request_.flat_mm, "width of its flat top or bottom [mm]")->check(CLI::Range(0.0, 5000.0));
    app.add_option("--length-mm", request_.length_mm, "trench and ridge: length of it [mm]")->check(CLI::Range(0.0, 5000.0));
    app.add_option("--at", request_.at_m, "middle of the goal, X Y in the box [m]; default: its middle")->expected(2);
    app.add_option("--size", request_.size_m, "width of the goal before it turns [m]")->check(CLI::Range(1e-3, 10.0));
    app.add_option("--rotate-deg", request_.turn_deg, "turns it, counter-clockwise from above [deg]");
    app.add_option("--zero", request_.zero, "its height 0 is: sand (mean height of the terrain) or floor");
    app.add_option("--lift-mm", request_.lift_mm, "raises all of it [mm]");
    app.add_option("--terrain", terrain_, "height map file: grid and sand")->required();
    app.add_option("--workcell", workcell_, "workcell (YAML): tells what is out of the arm's reach");
    app.add_option("--out", out_, "goal (height map file) to write")->required();
    app.add_option("--feasible", feasible_, "the nearest feasible goal to write; default: OUT_feasible.h5");
    app.add_option("--picture", picture_, "PNG to write: terrain, wish, feasible goal, difference");
  }
  void Fields(FieldList& f) override { f.Section("goal", config_); }

  int Run() override {
    const std::filesystem::path out = out_;
    if (feasible_.empty()) feasible_ = (out.parent_path() / (out.stem().string() + "_feasible.h5")).string();
    const HeightMap terrain = ReadHeightMap(terrain_);
    const std::unique_ptr<const SafetyGate> gate = LoadGate(workcell_);
    const ReachMap* reach = gate ? &gate->reach() : nullptr;
    const Wish wish = MakeWish(request_, terrain);
    const HeightMap feasible = NearestFeasible(wish.goal, terrain, config_);
    const Feasibility wished = JudgeGoal(wish.goal, terrain, config_, reach);
    nlohmann::json result = {{"out", out_}, {"feasible_out", feasible_}, {"cut_share", wish.cut_share}, {"wish", ToJson(wished)},
                             {"feasible", ToJson(JudgeGoal(feasible, terrain, config_, reach))}};
    AddChange(wish.goal, feasible, result);
    WriteHeightMap(wish.goal, out_);
    WriteHeightMap(feasible, feasible_);
    if (!picture_.empty()) WritePicture(DrawGoals(terrain, wish.goal, feasible), picture_);
    Tell(wished, result);
    WriteResult(result);
    return 0;
  }

 private:
  static void AddChange(const HeightMap& wish, const HeightMap& feasible, nlohmann::json& result) {
    double sum_m = 0, largest_m = 0, counted = 0;
    for (size_t i = 0; i < wish.size(); ++i) {
      if (!wish.mask[i]) continue;
      const double change_m = std::abs(feasible.height_m[i] - wish.height_m[i]);
      sum_m += change_m, largest_m = std::max(largest_m, change_m), ++counted;
    }
    result["counted_share"] = counted / static_cast<double>(wish.size());
    result["mean_change_mm"] = 1e3 * sum_m / counted;
    result["largest_change_mm"] = 1e3 * largest_m;
  }

  void Tell(const Feasibility& wish, const nlohmann::json& result) const {
    const double missing_cm3 = 1e6 * wish.volume_missing_m3;
    fmt::print("{:.0f} % of the box counts; sand {}: {:.0f} cm3\n", 100 * result["counted_share"].get<double>(),
               missing_cm3 > 0 ? "missing" : "left over", std::abs(missing_cm3));
    fmt::print("steeper than {:g} degrees: {:.1f} % of it, up to {:.0f}; too narrow: {:.1f} %, by up to {:.1f} mm\n",
               config_.repose_deg, 100 * wish.steep_share, wish.steepest_deg, 100 * wish.narrow_share, 1e3 * wish.narrow_worst_m);
    if (wish.out_of_reach_share) fmt::print("no stroke can start in {:.1f} % of it\n", 100 * *wish.out_of_reach_share);
    if (wish.below_floor_share > 0) fmt::print("below the floor: {:.1f} % of it\n", 100 * wish.below_floor_share);
    if (result["cut_share"] > 0.01) spdlog::warn("{:.0f} % of it lies beyond the walls", 100 * result["cut_share"].get<double>());
    fmt::print("nearest feasible goal: {:.2f} mm away in the mean, {:.1f} mm at most: {}\n", result["mean_change_mm"].get<double>(),
               result["largest_change_mm"].get<double>(), feasible_);
  }

  FeasibilityConfig config_;
  GoalRequest request_;
  std::string terrain_, workcell_, out_, feasible_, picture_;
};

}  // namespace

std::unique_ptr<Command> MakeGoalCommand() { return std::make_unique<GoalCommand>(); }

}  // namespace sandwright
