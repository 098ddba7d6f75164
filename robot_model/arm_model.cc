#include "robot_model/arm_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "data/base/error.h"

namespace sandwright {
namespace {

constexpr double kSteel[] = {0.55, 0.57, 0.60}, kWood[] = {0.62, 0.46, 0.30},
                 kDark[] = {0.16, 0.17, 0.19}, kTable[] = {0.72, 0.74, 0.76},
                 kSand[] = {0.88, 0.75, 0.53};

struct DeleteSpec {
  void operator()(mjSpec* spec) const { mj_deleteSpec(spec); }
};

void Place(const Eigen::Isometry3d& X, double (&pos)[3], double (&quat)[4]) {
  const Eigen::Quaterniond q(X.linear());
  std::ranges::copy(X.translation(), pos);
  quat[0] = q.w(), quat[1] = q.x(), quat[2] = q.y(), quat[3] = q.z();
}

mjsGeom* AddGeom(mjsBody* body, const std::string& name, mjtGeom type, const Eigen::Isometry3d& X,
                 const Eigen::Vector3d& size, const double (&rgb)[3]) {
  mjsGeom* geom = mjs_addGeom(body, nullptr);
  mjs_setName(geom->element, name.c_str());
  geom->type = type;
  Place(X, geom->pos, geom->quat);
  std::ranges::copy(size, geom->size);
  for (int i = 0; i < 3; ++i) geom->rgba[i] = static_cast<float>(rgb[i]);
  geom->contype = geom->conaffinity = 0;  // distances are asked for pair by pair
  geom->mass = 0;
  return geom;
}

void AddBoxOnTable(mjsBody* world, const Workcell& cell) {
  const BoxSettings& box = cell.box;
  const Eigen::Isometry3d X_WB = cell.X_WB.ToIsometry();
  const auto block = [&](const std::string& name, const Eigen::Vector3d& low,
                         const Eigen::Vector3d& high, const double(&rgb)[3]) {
    AddGeom(world, name, mjGEOM_BOX, X_WB * Eigen::Translation3d(0.5 * (low + high)),
            0.5 * (high - low), rgb);
  };
  const double w = box.width_m, d = box.depth_m, t = box.wall_thickness_m, h = box.wall_height_m;
  const double table = -box.floor_thickness_m;
  block("wall_0", {-t, -t, table}, {0, d + t, h}, kWood);
  block("wall_1", {w, -t, table}, {w + t, d + t, h}, kWood);
  block("wall_2", {0, -t, table}, {w, 0, h}, kWood);
  block("wall_3", {0, d, table}, {w, d + t, h}, kWood);
  block("box_floor", {0, 0, table}, {w, d, 0}, kWood);
  // The table holds box and arm; the pedestal lifts the base off it.
  const Eigen::Vector3d base = X_WB.inverse().translation();
  const double reach = 0.3;
  block("table", {std::min(0.0, base.x()) - reach, std::min(0.0, base.y()) - reach, table - 0.03},
        {std::max(w, base.x()) + reach, std::max(d, base.y()) + reach, table}, kTable);
  const double post = base.z() - table;
  if (post <= 0) throw Error("workcell: X_WB puts the arm's base below the table under the box");
  AddGeom(world, "pedestal", mjGEOM_CYLINDER,
          Eigen::Isometry3d(Eigen::Translation3d(0, 0, -post / 2)),
          {box.pedestal_radius_m, post / 2, 0}, kDark);
}

constexpr const char* kLinks[6] = {"shoulder_link", "upper_arm_link", "forearm_link",
                                   "wrist_1_link",  "wrist_2_link",   "wrist_3_link"};

Eigen::Isometry3d AlongZ(double z_m) {
  return Eigen::Isometry3d(Eigen::Translation3d(0, 0, z_m));
}

// Puts the links where the arm's own parameters say; X_LF of the flange in the last link.
//
// A link's frame may lie anywhere on its joint's axis. Calibrated axes 2 to 4 are not quite
// parallel, so their common normals, and with them d2 and d3, can be hundreds of metres away and
// cancel; the frames are put where the nominal arm has them, so that the capsules stay on the arm.
Eigen::Isometry3d PlaceLinks(mjSpec* spec, const DhParameters& dh) {
  const auto step = [&](size_t i) {
    return Eigen::Isometry3d(Eigen::AngleAxisd(dh.theta_rad[i], Eigen::Vector3d::UnitZ()) *
                             Eigen::Translation3d(dh.a_m[i], 0, dh.d_m[i]) *
                             Eigen::AngleAxisd(dh.alpha_rad[i], Eigen::Vector3d::UnitX()));
  };
  const DhParameters nominal;
  // Where on its axis each frame lies, from the origin of the Denavit-Hartenberg frame before it.
  std::array<double, 6> along = {dh.d_m[0], 0, 0, 0, dh.d_m[4], dh.d_m[5]};
  along[2] = -dh.d_m[1] / std::cos(dh.alpha_rad[1]);
  along[3] = (nominal.d_m[3] + along[2] - dh.d_m[2]) / std::cos(dh.alpha_rad[2]);
  Eigen::Isometry3d X = AlongZ(along[0]);
  for (size_t i = 0; i < 6; ++i) {
    mjsBody* link = mjs_findBody(spec, kLinks[i]);
    Place(X, link->pos, link->quat);
    X = AlongZ(-along[i]) * step(i) * AlongZ(i < 5 ? along[i + 1] : 0);
  }
  return X;
}

// `X_LF`: the flange in the body that carries the tool.
void AddTool(mjsBody* link, const Eigen::Isometry3d& X_LF, const ToolSettings& tool) {
  const Eigen::Isometry3d X_FT = tool.X_FT.ToIsometry(), X_FC = tool.X_FC.ToIsometry();
  const double plate = tool.blade_height_m;
  AddGeom(link, "blade", mjGEOM_BOX, X_LF * X_FT * Eigen::Translation3d(0, 0, -plate / 2),
          {tool.blade.thickness_m / 2, tool.blade.width_m / 2, plate / 2}, kSteel);
  const Eigen::Vector3d top = X_FT * Eigen::Vector3d(0, 0, -plate);  // of the plate, in F
  const double length = std::max(top.norm(), 1e-3);
  Eigen::Isometry3d X_FH = Eigen::Isometry3d::Identity();
  X_FH.linear() =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), top / length).toRotationMatrix();
  X_FH.translation() = top / 2;
  AddGeom(link, "holder", mjGEOM_CYLINDER, X_LF * X_FH, {tool.holder_radius_m, length / 2, 0}, kSteel);
  AddGeom(link, "camera", mjGEOM_BOX, X_LF * X_FC,
          0.5 * Eigen::Map<const Eigen::Vector3d>(tool.camera_body_m.data()), kDark);
  // The bracket that carries the camera.
  const Eigen::Vector3d camera = X_FC.translation();
  Eigen::Isometry3d X_FK = Eigen::Isometry3d::Identity();
  X_FK.linear() =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), camera).toRotationMatrix();
  X_FK.translation() = camera / 2;
  AddGeom(link, "bracket", mjGEOM_CAPSULE, X_LF * X_FK, {0.008, std::max(camera.norm() / 2, 1e-3), 0},
          kSteel);
  const auto site = [&](const char* name, const Eigen::Isometry3d& X) {
    mjsSite* added = mjs_addSite(link, nullptr);
    mjs_setName(added->element, name);
    Place(X_LF * X, added->pos, added->quat);
    added->size[0] = 1e-3;
    added->group = 5;  // not drawn
  };
  site("T", X_FT);
  site("C", X_FC);
}

void AddSand(mjSpec* spec, mjsBody* world, const Workcell& cell, const HeightMap& terrain) {
  const auto [low, high] = std::ranges::minmax(terrain.height_m);
  const double top = std::max<double>(high, 1e-3);
  mjsHField* field = mjs_addHField(spec);
  mjs_setName(field->element, "sand");
  field->nrow = terrain.rows;
  field->ncol = terrain.columns;
  // MuJoCo scales the data so that its lowest is 0 and its highest 1; the size restores metres.
  const double range = std::max<double>(high - low, 1e-6);
  const double half_x = 0.5 * terrain.width_m(), half_y = 0.5 * terrain.depth_m();
  const double size[4] = {half_x, half_y, range, std::max<double>(low, 1e-3)};
  std::ranges::copy(size, field->size);
  std::vector<float> rows(terrain.height_m.begin(), terrain.height_m.end());
  mjs_setFloat(field->userdata, rows.data(), static_cast<int>(rows.size()));
  mjsGeom* geom = AddGeom(
      world, "sand", mjGEOM_HFIELD,
      cell.X_WB.ToIsometry() * Eigen::Translation3d(half_x, half_y, top - range), {0, 0, 0}, kSand);
  mjs_setString(geom->hfieldname, "sand");
}

// Daylight for pictures: one lamp over the box, a pale background.
void AddLight(mjSpec* spec, mjsBody* world, const Workcell& cell) {
  const Eigen::Vector3d lamp =
      cell.X_WB.ToIsometry() * Eigen::Vector3d(-0.3, cell.box.depth_m + 0.5, 2.5);
  const Eigen::Vector3d aim =
      cell.X_WB.ToIsometry() * Eigen::Vector3d(cell.box.width_m / 2, cell.box.depth_m / 2, 0);
  mjsLight* light = mjs_addLight(world, nullptr);
  std::ranges::copy(lamp, light->pos);
  std::ranges::copy((aim - lamp).normalized(), light->dir);
  light->type = mjLIGHT_DIRECTIONAL;
  std::ranges::fill(light->ambient, 0.10f);
  std::ranges::fill(light->diffuse, 0.40f);
  std::ranges::fill(light->specular, 0.1f);
  mjsTexture* sky = mjs_addTexture(spec, nullptr);
  mjs_setName(sky->element, "sky");
  sky->type = mjTEXTURE_SKYBOX;
  sky->builtin = mjBUILTIN_GRADIENT;
  sky->width = sky->height = 64;
  std::ranges::fill(sky->rgb1, 0.97);
  std::ranges::fill(sky->rgb2, 0.85);
}

}  // namespace

MujocoModel MakeArmModel(const Workcell& workcell, const HeightMap* terrain) {
  std::array<char, 500> message = {};
  const std::unique_ptr<mjSpec, DeleteSpec> spec(
      mj_parseXMLString(kUr10Xml, nullptr, message.data(), static_cast<int>(message.size())));
  SAND_CHECK(spec, message.data());
  spec->memory = 1 << 16;  // no contacts, no dynamics: one mjData a thread stays small
  mjsBody* world = mjs_findBody(spec.get(), "world");
  AddBoxOnTable(world, workcell);
  const Eigen::Isometry3d X_LF = PlaceLinks(spec.get(), workcell.kinematics);
  AddTool(mjs_findBody(spec.get(), kLinks[5]), X_LF, workcell.tool);
  if (terrain) {
    spec->memory = 1 << 24;
    AddSand(spec.get(), world, workcell, *terrain);
    AddLight(spec.get(), world, workcell);
  }
  MujocoModel model(mj_compile(spec.get(), nullptr));
  SAND_CHECK(model, mjs_getError(spec.get()));
  SAND_CHECK(model->nq == 6, model->nq);
  return model;
}

MujocoData MakeArmData(const mjModel& model) {
  MujocoData data(mj_makeData(&model));
  SAND_CHECK(data);
  return data;
}

void SetJoints(const mjModel& model, const JointAngles& q, mjData& data) {
  std::ranges::copy(q.rad, data.qpos);
  mj_kinematics(&model, &data);
}

Eigen::Isometry3d SitePose(const mjModel& model, const mjData& data, const char* site) {
  const int id = mj_name2id(&model, mjOBJ_SITE, site);
  SAND_CHECK(id >= 0, site);
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() = Eigen::Map<const Eigen::Vector3d>(data.site_xpos + 3 * id);
  X.linear() =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(data.site_xmat + 9 * id);
  return X;
}

}  // namespace sandwright
