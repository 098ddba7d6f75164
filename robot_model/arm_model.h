// The arm in its cell as a MuJoCo model: ur10.xml with box, table, pedestal, blade and camera.
#pragma once

#include <mujoco/mujoco.h>

#include <memory>
#include <optional>

#include "data/height_map.h"
#include "robot_model/workcell.h"

namespace sandwright {

struct FreeMujoco {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
  void operator()(mjData* data) const { mj_deleteData(data); }
};
using MujocoModel = std::unique_ptr<mjModel, FreeMujoco>;
using MujocoData = std::unique_ptr<mjData, FreeMujoco>;

extern const char kUr10Xml[];

// World frame W. qpos are the six joints. Besides ur10.xml: geoms "wall_0".."wall_3", "box_floor",
// "table", "pedestal", "blade", "holder", "camera", "bracket" and sites "T" (blade) and "C"
// (camera). With a terrain there is also the height field "sand" (grid points at cell
// centres, for pictures; nothing collides with it).
MujocoModel MakeArmModel(const Workcell& workcell, const HeightMap* terrain = nullptr);
MujocoData MakeArmData(const mjModel& model);

// Places the arm and computes all frames of `data`.
void SetJoints(const mjModel& model, const JointAngles& q, mjData& data);
// Pose of a site ("T", "C") in W after SetJoints.
Eigen::Isometry3d SitePose(const mjModel& model, const mjData& data, const char* site);

}  // namespace sandwright
