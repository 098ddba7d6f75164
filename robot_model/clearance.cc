#include "robot_model/clearance.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "data/base/error.h"

namespace sandwright {
namespace {

using Names = std::vector<const char*>;

const Names kBase = {"base", "shoulder"};
const Names kUpperArm = {"upper_arm_shoulder", "upper_arm_tube", "upper_arm_elbow"};
const Names kForearm = {"forearm_elbow", "forearm_tube", "forearm_wrist"};
const Names kWrist = {"wrist_1", "wrist_2", "wrist_3"};
const Names kHand = {"holder", "camera", "bracket"};
const Names kSurroundings = {"wall_0",    "wall_1", "wall_2",  "wall_3",
                             "box_floor", "table",  "pedestal"};

// Groups that can meet. Neighbours in the chain overlap by construction; camera and wrists keep
// their distance whatever the joints, since the camera hangs below them.
const std::vector<std::pair<Names, Names>> kMeetings = {
    {kUpperArm, {"wall_0", "wall_1", "wall_2", "wall_3", "box_floor", "table"}},
    {kForearm, kSurroundings},
    {kWrist, kSurroundings},
    {kHand, kSurroundings},
    {{"blade"}, {"pedestal"}},
    {kForearm, kBase},
    {kWrist, kBase},
    {kHand, kBase},
    {{"blade"}, kBase},
    {kWrist, kUpperArm},
    {kHand, kUpperArm},
    {{"blade"}, kUpperArm},
    {{"wrist_3"}, kForearm},
    {kHand, kForearm},
    {{"blade"}, kForearm},
};

Eigen::Map<const Eigen::Vector3d> Centre(const mjData& data, int geom) {
  return Eigen::Map<const Eigen::Vector3d>(data.geom_xpos + 3 * geom);
}

Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> Axes(const mjData& data, int geom) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(data.geom_xmat + 9 * geom);
}

}  // namespace

ClearanceModel::ClearanceModel(const Workcell& workcell)
    : model_(MakeArmModel(workcell)),
      X_BW_(workcell.X_WB.ToIsometry().inverse()),
      width_m_(workcell.box.width_m),
      depth_m_(workcell.box.depth_m) {
  const auto id = [&](const char* name) {
    const int geom = mj_name2id(model_.get(), mjOBJ_GEOM, name);
    SAND_CHECK(geom >= 0, name);
    return geom;
  };
  for (const auto& [movers, others] : kMeetings) {
    for (const char* mover : movers) {
      for (const char* other : others) {
        const int geom = id(other);
        pairs_.push_back({id(mover), geom, model_->geom_type[geom] == mjGEOM_BOX});
      }
    }
  }
  for (const Names* names : {&kUpperArm, &kForearm, &kWrist})
    for (const char* name : *names) over_sand_.push_back(id(name));
  over_sand_.push_back(id("camera"));
}

double ClearanceModel::AtLeast(const Pair& pair, const mjData& data) const {
  const Eigen::Vector3d offset = Centre(data, pair.a) - Centre(data, pair.b);
  const double radius = model_->geom_rbound[pair.a];
  if (!pair.b_is_box) return offset.norm() - radius - model_->geom_rbound[pair.b];
  const Eigen::Map<const Eigen::Vector3d> half(model_->geom_size + 3 * pair.b);
  const Eigen::Vector3d outside = (Axes(data, pair.b).transpose() * offset).cwiseAbs() - half;
  return outside.cwiseMax(0).norm() - radius;
}

ClearanceModel::Lease::Lease(const ClearanceModel& model) : model_(model) {
  {
    const std::lock_guard lock(model.mutex_);
    if (!model.idle_.empty()) {
      data_ = std::move(model.idle_.back());
      model.idle_.pop_back();
    }
  }
  if (!data_) data_ = MakeArmData(*model.model_);
}

ClearanceModel::Lease::~Lease() {
  const std::lock_guard lock(model_.mutex_);
  model_.idle_.push_back(std::move(data_));
}

ClearanceModel::Nearest ClearanceModel::Lease::At(const JointAngles& q, double seen_m) {
  const mjModel& model = *model_.model_;
  SetJoints(model, q, *data_);
  double distance = seen_m;
  const Pair* nearest = nullptr;
  for (const Pair& pair : model_.pairs_) {
    if (model_.AtLeast(pair, *data_) >= distance) continue;
    const double d = mj_geomDistance(&model, data_.get(), pair.a, pair.b, distance, nullptr);
    if (d < distance) distance = d, nearest = &pair;
  }
  if (!nearest) return {distance, ""};
  return {distance, std::string(mj_id2name(&model, mjOBJ_GEOM, nearest->a)) + " and " +
                        mj_id2name(&model, mjOBJ_GEOM, nearest->b)};
}

double ClearanceModel::Lease::AboveSand(double sand_top_m, double seen_m) const {
  const mjModel& model = *model_.model_;
  double lowest = seen_m;
  for (int geom : model_.over_sand_) {
    const Eigen::Vector3d centre = model_.X_BW_ * Centre(*data_, geom);
    const double reach = model.geom_rbound[geom];
    if (centre.x() < -reach || centre.x() > model_.width_m_ + reach || centre.y() < -reach ||
        centre.y() > model_.depth_m_ + reach)
      continue;
    // Half extent along B's z: a capsule is a segment of half-length
    // size[1] plus size[0] around it.
    const Eigen::RowVector3d up = model_.X_BW_.linear().row(2) * Axes(*data_, geom);
    const double* size = model.geom_size + 3 * geom;
    const double half = model.geom_type[geom] == mjGEOM_CAPSULE
                            ? size[0] + size[1] * std::abs(up.z())
                            : up.cwiseAbs().dot(Eigen::Map<const Eigen::RowVector3d>(size));
    lowest = std::min(lowest, centre.z() - half - sand_top_m);
  }
  return lowest;
}

}  // namespace sandwright
