#include "env/dem_run.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>

#include "data/base/atomic_file.h"
#include "data/base/error.h"
#include "data/base/process.h"

namespace sandwright {

double GrainMaterial::mass_kg() const {
  return density_kgpm3 * std::numbers::pi / 6 * std::pow(grain_m, 3);
}

// A share of the contact of two mean grains, pi sqrt(reduced mass / stiffness).
double GrainMaterial::time_step_s() const {
  return time_step_share * std::numbers::pi * std::sqrt(mass_kg() / 2 / stiffness_npm());
}

namespace {

constexpr double kRest_mps = 0.001;  // rms speed below which a bed is at rest: no grain moves on
constexpr double kSample_s = 0.02;   // between two samples of overlap, speed and load
constexpr int64_t kLoadStride = 10;  // steps between two looks at the blade's load
constexpr double kBladeHeight_m = 0.2;
constexpr double kMargin_m = 0.01;  // of the simulated box around its grains

// Linear spring and damping, Coulomb friction with history, rolling friction as a spring and slider.
std::string ContactLaw(const GrainMaterial& m, double friction) {
  const double stiffness = m.stiffness_npm();
  const double damping = 2 * m.damping * std::sqrt(stiffness * m.mass_kg() / 2);
  return fmt::format(
      "hooke {:.9g} {:.9g} tangential linear_history {:.9g} 1.0 {:.9g} rolling sds {:.9g} {:.9g} "
      "{:.9g} "
      "twisting none damping velocity",
      stiffness, damping, 0.75 * stiffness, friction, stiffness / 1.2, damping / 4,
      m.rolling_friction);
}

std::string Walls(const GrainMaterial& m, const DemScene& scene) {
  const std::string law = ContactLaw(m, scene.wall_friction.value_or(m.friction));
  std::string text = fmt::format("fix floor moving wall/gran granular {} zplane 0 NULL\n",
                                 ContactLaw(m, m.friction));
  for (int axis = 0; axis < 2; ++axis) {
    const auto side = [&](bool wall, double at) {
      return wall ? fmt::format("{:.17g}", at) : "NULL";
    };
    if (scene.wall_low[axis] || scene.wall_high[axis])
      text += fmt::format("fix wall{0} moving wall/gran granular {1} {0}plane {2} {3}\n",
                          "xy"[axis], law, side(scene.wall_low[axis], scene.low_m[axis]),
                          side(scene.wall_high[axis], scene.high_m[axis]));
  }
  return text;
}

std::string Contacts(const GrainMaterial& m) {
  return fmt::format("pair_coeff * * {}\n", ContactLaw(m, m.friction));
}

std::string Preamble(const GrainMaterial& m, const DemScene& scene) {
  const double dt = m.time_step_s();
  return fmt::format(
             "units si\natom_style sphere\natom_modify map array\nnewton off\ncomm_modify vel yes\n"
             "boundary f f f\nneighbor {:.9g} bin\nneigh_modify delay 0 every 1 check yes\n"
             "read_data grains.data\nneigh_modify exclude type 2 2\ngroup moving type 1\n",
             m.grain_m / 4) +
         "pair_style granular\n" + Contacts(m) + Walls(m, scene) +
         fmt::format(
             "fix gravity moving gravity 9.81 vector 0 0 -1\nfix motion moving "
             "nve/sphere\ntimestep {:.9g}\n"
             "compute force all pair/local force\ncompute strongest all reduce max c_force\n"
             "compute squares all reduce sumsq c_force\n"
             "variable speed2 atom vx*vx+vy*vy+vz*vz\ncompute fastest2 moving reduce max v_speed2\n"
             "compute mean2 moving reduce ave v_speed2\nvariable fastest equal sqrt(c_fastest2)\n"
             "variable rms equal sqrt(c_mean2)\n"
             "compute flight moving ke\ncompute spin moving erotate/sphere\n"
             "variable kinetic equal c_flight+c_spin\n"
             "thermo_style custom step atoms c_strongest v_fastest v_rms v_kinetic f_gravity c_squares\n"
             "thermo {}\nthermo_modify lost ignore flush yes\n",
             dt, std::max<int64_t>(1, std::llround(kSample_s / dt)));
}

int64_t LoadSteps(const GrainMaterial& m) {
  constexpr double kLoad_s = 0.04;
  return std::llround(kLoad_s / m.time_step_s());
}

// Grains from a file have no contact history: their springs are slack, and slopes would creep until they
// are loaded again. Rough and damped they load up almost on the spot. The steps go on from there: after
// a reset LAMMPS takes its old list of pairs for a new one, and stops where a grain of it was lost.
std::string LoadContacts(const GrainMaterial& m) {
  GrainMaterial rough = m;
  rough.friction = rough.rolling_friction = 10;
  const double drag = 0.2 * m.mass_kg() / (100 * m.time_step_s());
  return Contacts(rough) +
         fmt::format("fix calm moving viscous {:.9g}\nrun {} post no\nunfix calm\n", drag,
                     LoadSteps(m)) +
         Contacts(m);
}

std::string CloseGate(const GrainMaterial& m, const DemGate& gate) {
  constexpr double kFar_m = 100;
  const std::string region =
      gate.radius_m > 0 ? fmt::format("cylinder z {:.17g} {:.17g} {:.17g} -{}", gate.x_m, gate.y_m,
                                      gate.radius_m, kFar_m)
                        : fmt::format("block -{1} {0:.17g} -{1} {1} -{1}", gate.x_m, kFar_m);
  return fmt::format(
      "region gate {} {} side in\nfix gate moving wall/gran/region granular {} region gate\n",
      region, kFar_m, ContactLaw(m, 0));
}

// Waits in slices until the grains are at rest, at most `seconds`. Slices follow each other without a
// set-up: that would drop lost grains and keep the list of pairs that names them, where LAMMPS stops.
std::string ComeToRest(const GrainMaterial& m, double seconds) {
  constexpr double kSlice_s = 0.04;
  const int64_t steps = std::llround(kSlice_s / m.time_step_s());
  return fmt::format(
      "run {0} post no\nvariable slice loop {1}\nlabel wait\n"
      "if \"$(v_rms) < {2}\" then \"jump SELF rested\"\n"
      "run {0} pre no post no\nnext slice\njump SELF wait\nlabel rested\n"
      "write_dump all custom rest.txt id x y z modify sort id format float %.17g\n",
      steps, std::max<int64_t>(1, std::llround(seconds / kSlice_s) - 1), kRest_mps);
}

// The blade as a block that moves by variables of the step: exact contact, and its own velocity counts.
std::string BladeScript(const DemConfig& c, std::span<const BladeMove> moves) {
  const Blade& b = c.blade;
  std::string text;
  const double dt = c.material.time_step_s();
  int64_t step = LoadSteps(c.material);
  for (size_t i = 0; i < moves.size(); ++i) {
    const BladeMove& move = moves[i];
    const auto steps = std::max<int64_t>(1, std::llround(move.seconds / dt));
    const auto ramp = [&](const char* name, double from, double to) {
      text += fmt::format("variable {} equal {:.17g}+{:.17g}*(step-{})\n", name, from,
                          (to - from) / static_cast<double>(steps), step);
    };
    ramp("blade_x", move.from.x_m, move.to.x_m);
    ramp("blade_y", move.from.y_m, move.to.y_m);
    ramp("blade_z", move.from.z_m, move.to.z_m);
    ramp("blade_yaw", move.from.yaw_rad, move.to.yaw_rad);
    if (i == 0) {
      text += fmt::format(
          "region blade block {} {} {} {} 0 {} side out move v_blade_x v_blade_y v_blade_z "
          "rotate v_blade_yaw 0 0 0 0 0 1\nfix blade moving wall/gran/region granular {} region "
          "blade contacts\n",
          -b.thickness_m / 2, b.thickness_m / 2, -b.width_m / 2, b.width_m / 2, kBladeHeight_m,
          ContactLaw(c.material, c.blade_friction));
      const int64_t means = std::max<int64_t>(1, std::llround(kSample_s / dt / kLoadStride));
      text += fmt::format(
          "compute load moving reduce sum f_blade[2] f_blade[3] f_blade[4]\n"
          "fix load moving ave/time {} {} {} c_load[1] c_load[2] c_load[3] file load.txt\n",
          kLoadStride, means, kLoadStride * means);
    }
    text += fmt::format("run {} post no\n", steps);
    step += steps;
  }
  if (!moves.empty()) text += "unfix load\nuncompute load\nunfix blade\n";
  return text;
}

void WriteGrains(const DemConfig& c, const DemScene& scene, const std::filesystem::path& file) {
  double top = 0;
  for (const Grain& g : scene.grains) top = std::max(top, g.z_m);
  std::string text = fmt::format(
      "grains\n\n{} atoms\n2 atom types\n{:.17g} {:.17g} xlo xhi\n{:.17g} {:.17g} ylo yhi\n{} {} "
      "zlo zhi\n\n"
      "Atoms # sphere\n\n",
      scene.grains.size(), scene.low_m[0] - kMargin_m, scene.high_m[0] + kMargin_m,
      scene.low_m[1] - kMargin_m, scene.high_m[1] + kMargin_m, -kMargin_m, top + kBladeHeight_m);
  for (size_t i = 0; i < scene.grains.size(); ++i) {
    const Grain& g = scene.grains[i];
    fmt::format_to(std::back_inserter(text), "{} {} {:.17g} {} {:.17g} {:.17g} {:.17g}\n", i + 1,
                   scene.held[i] ? 2 : 1, 2 * g.radius_m, c.material.density_kgpm3, g.x_m, g.y_m,
                   g.z_m);
  }
  if (!scene.velocity_mps.empty()) text += "\nVelocities\n\n";
  for (size_t i = 0; i < scene.velocity_mps.size(); ++i) {
    const Eigen::Vector3d& v = scene.velocity_mps[i];
    fmt::format_to(std::back_inserter(text), "{} {:.17g} {:.17g} {:.17g} 0 0 0\n", i + 1, v.x(),
                   v.y(), v.z());
  }
  WriteFileAtomically(file, text);
}

// Samples from what LAMMPS printed: lines "step atoms force fastest rms kinetic height squares".
void ReadOutput(const GrainMaterial& m, const std::string& output, int64_t first_step,
                DemReport& report) {
  std::istringstream lines(output);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    int64_t step;
    double atoms, force_n, fastest_mps, rms_mps, kinetic_j, height_j, squares_n2;
    if (!(words >> step >> atoms >> force_n >> fastest_mps >> rms_mps >> kinetic_j >> height_j >>
          squares_n2) ||
        !(words >> std::ws).eof())
      continue;
    const double overlap = force_n / (m.stiffness_npm() * m.grain_m);
    const double time_s = static_cast<double>(step - first_step) * m.time_step_s();
    if (time_s >= 0 && (report.samples.empty() || time_s > report.samples.back().time_s))
      report.samples.push_back(
          {time_s, kinetic_j, height_j, squares_n2 / (2 * m.stiffness_npm()), overlap});
    report.simulated_s = time_s;
    report.deepest_overlap = std::max(report.deepest_overlap, overlap);
    report.fastest_mps = std::max(report.fastest_mps, fastest_mps);
    report.rest_speed_mps = rms_mps;
  }
}

// Lines "step x y z" of the sums over the contacts with the blade.
void ReadLoads(const GrainMaterial& m, const std::filesystem::path& file, int64_t first_step,
               DemReport& report) {
  std::ifstream loads(file);
  for (std::string line; std::getline(loads, line);) {
    std::istringstream words(line);
    int64_t step;
    double x, y, z;
    if (words >> step >> x >> y >> z)
      report.blade_loads.push_back(
          {static_cast<double>(step - first_step) * m.time_step_s(), -Eigen::Vector3d(x, y, z)});
  }
}

std::string LastError(const std::string& output) {
  const size_t at = output.rfind("ERROR");
  return at == std::string::npos ? "no message" : output.substr(at, output.find('\n', at) - at);
}

// Where the grains came to rest. A grain that was lost keeps its old place, with radius 0.
void ReadRest(const std::filesystem::path& file, DemScene& scene, DemReport& report) {
  std::ifstream rest(file);
  std::string line;
  while (std::getline(rest, line) && !line.starts_with("ITEM: ATOMS")) continue;
  std::vector<uint8_t> found(scene.grains.size(), 0);
  size_t id;
  for (double x, y, z; rest >> id >> x >> y >> z;) {
    SAND_CHECK(id >= 1 && id <= scene.grains.size(), id);
    Grain& g = scene.grains[id - 1];
    found[id - 1] = 1;
    if (!scene.held[id - 1]) g.x_m = x, g.y_m = y, g.z_m = z;
  }
  for (size_t i = 0; i < found.size(); ++i) {
    if (found[i]) continue;
    ++report.grains_lost;
    scene.grains[i].radius_m = 0;
  }
}

// The report counts time from `first_step` on.
DemReport Run(const DemConfig& config, const std::string& script, int64_t first_step,
              DemScene& scene, const std::function<bool()>& stop) {
  if (!FindProgram("lmp"))
    throw Error(
        "sand model 'dem' (grains) needs LAMMPS with its package GRANULAR: no program `lmp` on "
        "PATH; "
        "Debian and Ubuntu: apt-get install lammps");
  const TemporaryFolder folder;
  WriteGrains(config, scene, folder.path() / "grains.data");
  WriteFileAtomically(folder.path() / "in.lmp", script);
  std::vector<std::string> words = {"lmp", "-in", "in.lmp", "-log", "none"};
  if (config.ranks > 1)
    words.insert(words.begin(), {"mpirun", "--oversubscribe", "--allow-run-as-root", "--mca",
                                 "mpi_yield_when_idle", "1", "-n", std::to_string(config.ranks)});
  DemReport report;
  report.grains_moving = std::ranges::count(scene.held, uint8_t{0});
  const auto start = std::chrono::steady_clock::now();
  const int status = RunProgram(words, folder.path(), stop);
  report.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const std::string output = ReadFile(folder.path() / "output.txt");
  if (status != 0 || !std::filesystem::exists(folder.path() / "rest.txt"))
    throw Error(fmt::format("LAMMPS ended with status {}: {}", status, LastError(output)),
                ErrorKind::kInternal);
  ReadOutput(config.material, output, first_step, report);
  ReadLoads(config.material, folder.path() / "load.txt", first_step, report);
  ReadRest(folder.path() / "rest.txt", scene, report);
  return report;
}

}  // namespace

DemReport SettleGrains(const DemConfig& config, DemScene& scene,
                       const std::function<bool()>& stop) {
  constexpr double kFall_s = 0.45, kSettle_s = 0.08;
  // Without rolling friction by its coefficient: a contact law with another history in the middle of a
  // run reads what is not there (LAMMPS of January 2022).
  GrainMaterial rolling_freely = config.material;
  rolling_freely.rolling_friction = 0;
  const std::string script =
      Preamble(rolling_freely, scene) +
      fmt::format("run {} post no\n", std::llround(kFall_s / config.material.time_step_s())) +
      Contacts(config.material) + "unfix floor\nunfix wallx\nunfix wally\n" +
      Walls(config.material, scene) + ComeToRest(config.material, kSettle_s);
  return Run(config, script, 0, scene, stop);
}

DemReport RunGrains(const DemConfig& config, std::span<const BladeMove> moves, DemScene& scene,
                    const std::function<bool()>& stop) {
  const std::string load = LoadContacts(config.material);
  const std::string loaded =
      scene.gate ? CloseGate(config.material, *scene.gate) + load + "unfix gate\n" : load;
  return Run(config,
             Preamble(config.material, scene) + loaded + BladeScript(config, moves) +
                 ComeToRest(config.material, config.settle_s),
             LoadSteps(config.material), scene, stop);
}

}  // namespace sandwright
