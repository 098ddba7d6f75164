// The native half of the Python package: sandwright::ShapingEnv with its world, over numpy arrays.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <spdlog/fmt/fmt.h>

#include <opencv2/imgproc.hpp>

#include "data/picture.h"
#include "data/task.h"
#include "env/cell_action.h"
#include "env/load_gate.h"
#include "env/reference/numpy_normal.h"
#include "env/reference/reference_vec_env.h"
#include "env/sand_model_by_name.h"
#include "env/shaping_env.h"

namespace nb = nanobind;

namespace sandwright {
namespace {

// What a Python environment is made of: the keys of env/ with the world and the tasks beside them.
struct GymConfig {
  std::string world = "default", workcell, tasks;
  int64_t threads = 1;
  ShapingConfig env = {.num_envs = 1, .random_phase = false};
  TaskConfig task;
  CellActionConfig cells;
  SandModelConfig sand;

  void Fields(FieldList& f) {
    f.Add("world", world, "sand model: heightfield, default (the shipped surrogate), dem, none or a file");
    f.Add("workcell", workcell,
          "workcell whose gate refuses strokes: a file, or a name in configs/; empty: no arm");
    f.Add("tasks", tasks, "task file to draw from; empty: tasks without end, by the keys task");
    f.Add("threads", threads, "threads of a batch; results do not depend on it", 1, 1024);
    env.Fields(f);
    f.Section("task", task);
    f.Section("cells", cells);
    sand.Fields(f);
  }
};

Autoreset AutoresetOf(const std::string& name) {
  if (name == "same_step") return Autoreset::kSameStep;
  if (name == "next_step") return Autoreset::kNextStep;
  if (name == "disabled") return Autoreset::kDisabled;
  throw Error("autoreset '" + name + "'; allowed: same_step, next_step, disabled");
}

using Strings = std::vector<std::string>;

// An array that owns `values`.
template <class T>
nb::ndarray<nb::numpy, T> ToNumpy(std::vector<T> values, std::vector<size_t> shape) {
  auto* owned = new std::vector<T>(std::move(values));
  nb::capsule owner(owned, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  return nb::ndarray<nb::numpy, T>(owned->data(), shape.size(), shape.data(), owner);
}

nb::object MapToNumpy(const std::vector<float>& values, const HeightMap& map) {
  return nb::cast(ToNumpy<float>(values, {static_cast<size_t>(map.rows),
                                          static_cast<size_t>(map.columns)}));
}

class NativeEnv {
 public:
  NativeEnv(const std::string& config_json, const std::string& autoreset) {
    const nlohmann::json asked = nlohmann::json::parse(config_json);
    LoadJson(FieldsOf(config_), asked, "sandwright environment");
    config_.sand.heightfield.threads = config_.threads;
    sand_ = SandModelByName(config_.world, config_.sand);
    if (sand_->cell_size_m() && !(asked.contains("task") && asked["task"].contains("cell_size_m")))
      config_.task.cell_size_m = *sand_->cell_size_m();
    gate_ = LoadGate(config_.workcell);
    const World world{*sand_, gate_.get(), static_cast<int>(config_.threads)};
    TaskSource tasks =
        config_.tasks.empty() ? TasksFrom(config_.task) : TasksFrom(ReadTasks(config_.tasks));
    env_.emplace(config_.env, world, std::move(tasks), AutoresetOf(autoreset));
  }

  size_t num_envs() const { return static_cast<size_t>(env_->num_envs()); }
  std::string config() { return ToJson(FieldsOf(config_)).dump(); }

  nb::dict Spec() const {
    const ObservationSpec& spec = env_->observation_spec();
    nb::dict dict;
    dict["channels"] = spec.channels;
    dict["rows"] = spec.rows;
    dict["columns"] = spec.columns;
    dict["numbers"] = spec.numbers;
    dict["map_limit"] = spec.map_limit;
    dict["vec_high"] = spec.vec_high;
    Strings actions;
    for (const ActionEntry& entry : kActionSpec) actions.emplace_back(entry.name);
    dict["actions"] = actions;
    const CellAction sizes = CellActionSizes(config_.cells);
    dict["cell_actions"] = std::vector<int64_t>(sizes.begin(), sizes.end());
    return dict;
  }

  nb::tuple Reset(uint64_t seed) {
    ObservationBatch batch;
    {
      nb::gil_scoped_release release;
      batch = env_->Reset(seed);
    }
    return Arrays(std::move(batch));
  }

  nb::tuple ResetRows(const nb::ndarray<const uint8_t, nb::ndim<1>, nb::c_contig>& chosen,
                      const std::vector<std::optional<uint64_t>>& seeds) {
    if (chosen.size() != num_envs() || seeds.size() != num_envs())
      throw Error("reset: one mask and one seed for each of the " + std::to_string(num_envs()) +
                  " environments");
    ObservationBatch batch;
    {
      nb::gil_scoped_release release;
      batch = env_->Reset(std::span(chosen.data(), chosen.size()), seeds);
    }
    return Arrays(std::move(batch));
  }

  nb::dict Step(const nb::ndarray<const float, nb::ndim<2>, nb::c_contig>& actions) {
    CheckShape(actions, kActionSize);
    return Step(std::span(actions.data(), actions.size()));
  }

  nb::dict StepCells(const nb::ndarray<const int64_t, nb::ndim<2>, nb::c_contig>& choices) {
    CheckShape(choices, kCellActionSize);
    std::vector<float> actions;
    for (size_t i = 0; i < num_envs(); ++i) {
      CellAction choice;
      std::copy_n(choices.data() + i * kCellActionSize, kCellActionSize, choice.begin());
      const Action action = ActionOf(choice, config_.cells);
      actions.insert(actions.end(), action.begin(), action.end());
    }
    return Step(actions);
  }

  // [N, start cells] 1 where a stroke can start.
  nb::ndarray<nb::numpy, uint8_t> StartMasks() const {
    std::vector<uint8_t> masks;
    for (const EpisodeState& episode : env_->episodes()) {
      const std::vector<uint8_t> mask = StartMask(View(episode, gate_.get()), config_.cells);
      masks.insert(masks.end(), mask.begin(), mask.end());
    }
    const size_t cells = masks.size() / num_envs();
    return ToNumpy(std::move(masks), {num_envs(), cells});
  }

  ShapingEnv::State Save() const { return env_->state(); }
  nb::tuple Restore(const ShapingEnv::State& state) {
    if (state.episodes.size() != num_envs())
      throw Error("restore: a state of " + std::to_string(state.episodes.size()) +
                  " environments; this one has " + std::to_string(num_envs()));
    env_->Restore(state);
    return Arrays(env_->Observe());
  }

  // Heights, goal (NaN where it does not count) and the cells' size of one row's box.
  nb::tuple Maps(size_t row) const {
    const EpisodeState& episode = Episode(row);
    const HeightMap &heights = episode.sand.map(), &goal = episode.task->goal;
    std::vector<float> wanted = goal.height_m;
    for (size_t i = 0; i < wanted.size(); ++i) {
      if (!goal.mask[i]) wanted[i] = std::numeric_limits<float>::quiet_NaN();
    }
    return nb::make_tuple(MapToNumpy(heights.height_m, heights), MapToNumpy(wanted, goal),
                          heights.cell_size_m);
  }

  // Sand with the last stroke, and what is missing to the goal, side by side: RGB [height, width, 3].
  nb::ndarray<nb::numpy, uint8_t> Render(size_t row, int height_px) const {
    const EpisodeState& episode = Episode(row);
    const HeightMap &heights = episode.sand.map(), &goal = episode.task->goal;
    constexpr double kRange_m = 0.012;
    const auto [low, high] = std::ranges::minmax(episode.task->terrain.height_m);
    const int scale = std::max(1, static_cast<int>(std::lround(static_cast<double>(height_px) / heights.rows)));
    cv::Mat sand = DrawHeights(heights, low - kRange_m, high + kRange_m, scale);
    const auto& result = env_->results()[row];
    if (result && result->accepted())
      DrawPath(sand, heights, SamplePath(result->stroke, heights.cell_size_m / 2),
               sand_->blade(), scale);
    const cv::Mat missing = DrawDifference(heights, goal, kRange_m, scale);
    const cv::Mat gap(sand.rows, 8, sand.type(), cv::Scalar::all(255));
    cv::Mat both, rgb;
    cv::hconcat(std::vector<cv::Mat>{sand, gap, missing}, both);
    cv::cvtColor(both, rgb, cv::COLOR_BGR2RGB);
    return ToNumpy<uint8_t>({rgb.datastart, rgb.dataend},
                            {static_cast<size_t>(rgb.rows), static_cast<size_t>(rgb.cols), 3});
  }

 private:
  const EpisodeState& Episode(size_t row) const {
    if (row >= num_envs()) throw Error("no environment " + std::to_string(row));
    return env_->episodes()[row];
  }

  template <class Array>
  void CheckShape(const Array& actions, size_t size) const {
    if (actions.shape(0) != num_envs() || actions.shape(1) != size)
      throw Error("step: actions of shape [" + std::to_string(actions.shape(0)) + ", " +
                  std::to_string(actions.shape(1)) + "]; expected [" + std::to_string(num_envs()) +
                  ", " + std::to_string(size) + "]");
  }

  nb::dict Step(std::span<const float> actions) {
    StepBatch batch;
    {
      nb::gil_scoped_release release;
      batch = env_->Step(actions);
    }
    nb::dict dict;
    dict["observation"] = Arrays(std::move(batch.observation));
    dict["final_observation"] = Arrays(std::move(batch.final_observation));
    const size_t n = num_envs();
    nb::list finished;
    for (const EpisodeSummary& summary : batch.finished) {
      nb::dict metrics;
      for (const auto& [name, value] : summary.metrics) metrics[name.c_str()] = value;
      finished.append(nb::make_tuple(summary.episode_return, summary.length, metrics));
    }
    dict["finished"] = finished;
    AddResults(dict);
    dict["reward"] = ToNumpy(std::move(batch.reward), {n});
    dict["terminated"] = ToNumpy(std::move(batch.terminated), {n});
    dict["truncated"] = ToNumpy(std::move(batch.truncated), {n});
    return dict;
  }

  nb::tuple Arrays(ObservationBatch batch) const {
    const ObservationSpec& spec = env_->observation_spec();
    const auto size = [](int count) { return static_cast<size_t>(count); };
    return nb::make_tuple(ToNumpy(std::move(batch.map), {num_envs(), spec.channels.size(),
                                                         size(spec.rows), size(spec.columns)}),
                          ToNumpy(std::move(batch.vec), {num_envs(), spec.numbers.size()}));
  }

  // One array a figure; 0 where a row started anew instead of stepping.
  void AddResults(nb::dict& dict) const {
    const size_t n = num_envs();
    std::vector<double> progress(n), stroke_cost(n), outside_cost(n), rejected_cost(n), moved(n);
    std::vector<uint8_t> stepped(n), accepted(n);
    nb::list reasons;
    for (size_t i = 0; i < n; ++i) {
      const auto& result = env_->results()[i];
      nb::object why = nb::none();
      if (result) {
        stepped[i] = 1;
        accepted[i] = result->accepted();
        progress[i] = result->reward.progress;
        stroke_cost[i] = result->reward.stroke;
        outside_cost[i] = result->reward.outside;
        rejected_cost[i] = result->reward.rejected;
        moved[i] = 1e6 * result->outcome.moved_volume_m3;
        if (!result->accepted()) why = nb::cast(result->rejected_for);
      }
      reasons.append(why);
    }
    std::vector<double> error(n);
    for (size_t i = 0; i < n; ++i) error[i] = 1e3 * env_->episodes()[i].goal_error_m.back();
    dict["stepped"] = ToNumpy(std::move(stepped), {n});
    dict["accepted"] = ToNumpy(std::move(accepted), {n});
    dict["rejected_for"] = reasons;
    dict["reward_progress"] = ToNumpy(std::move(progress), {n});
    dict["reward_stroke"] = ToNumpy(std::move(stroke_cost), {n});
    dict["reward_outside"] = ToNumpy(std::move(outside_cost), {n});
    dict["reward_rejected"] = ToNumpy(std::move(rejected_cost), {n});
    dict["moved_volume_cm3"] = ToNumpy(std::move(moved), {n});
    dict["goal_error_mm"] = ToNumpy(std::move(error), {n});
  }

  GymConfig config_;
  std::unique_ptr<SandModel> sand_;
  std::unique_ptr<const SafetyGate> gate_;
  std::optional<ShapingEnv> env_;
};

// numpy.random.default_rng(seed).standard_normal(count), for a comparison.
nb::object StandardNormals(uint64_t seed, size_t count) {
  NumpyRandom random(seed);
  std::vector<double> values(count);
  for (double& value : values) value = StandardNormal(random);
  return nb::cast(ToNumpy(std::move(values), {count}));
}

// Reference tasks as Gymnasium's vector environments step them, for a comparison.
class NativeReference {
 public:
  NativeReference(const std::string& name, int num_envs, int threads) : env_(name, num_envs, threads) {}
  NativeReference(const NativeReference&) = delete;

  size_t num_envs() const { return static_cast<size_t>(env_.num_envs()); }
  nb::dict Spec() const {
    const ReferenceSpec& spec = env_.spec();
    nb::dict dict;
    dict["observation"] = spec.observation;
    dict["choices"] = spec.choices;
    dict["action_size"] = spec.action_size;
    dict["action_limit"] = spec.action_limit;
    dict["max_steps"] = spec.max_steps;
    return dict;
  }

  nb::object Reset(uint64_t seed) {
    ObservationBatch batch;
    {
      nb::gil_scoped_release release;
      batch = env_.Reset(seed);
    }
    return Array(std::move(batch));
  }

  nb::tuple Step(const nb::ndarray<const float, nb::ndim<2>, nb::c_contig>& actions) {
    const auto size = static_cast<size_t>(env_.action_size()), n = num_envs();
    if (actions.shape(0) != n || actions.shape(1) != size)
      throw Error(fmt::format("step: actions of shape [{}, {}]; expected [{}, {}]", actions.shape(0),
                              actions.shape(1), n, size));
    StepBatch batch;
    {
      nb::gil_scoped_release release;
      batch = env_.Step(std::span(actions.data(), actions.size()));
    }
    return nb::make_tuple(Array(std::move(batch.observation)), ToNumpy(std::move(batch.reward), {n}),
                          ToNumpy(std::move(batch.terminated), {n}),
                          ToNumpy(std::move(batch.truncated), {n}),
                          Array(std::move(batch.final_observation)));
  }

 private:
  nb::object Array(ObservationBatch batch) const {
    return nb::cast(ToNumpy(std::move(batch.vec),
                            {num_envs(), static_cast<size_t>(env_.observation_spec().vec_size())}));
  }

  ReferenceVecEnv env_;
};

}  // namespace
}  // namespace sandwright

NB_MODULE(_native, module) {
  using sandwright::NativeEnv;
  nb::register_exception_translator([](const std::exception_ptr& thrown, void*) {
    try {
      std::rethrow_exception(thrown);
    } catch (const sandwright::Error& error) {
      PyErr_SetString(error.kind() == sandwright::ErrorKind::kInternal ? PyExc_RuntimeError
                                                                       : PyExc_ValueError,
                      error.what());
    }
  });
  module.def("reference_task_names", &sandwright::ReferenceTaskNames);
  module.def("standard_normals", &sandwright::StandardNormals, nb::arg("seed"), nb::arg("count"));
  using sandwright::NativeReference;
  nb::class_<NativeReference>(module, "ReferenceVecEnv")
      .def(nb::init<const std::string&, int, int>(), nb::arg("name"), nb::arg("num_envs"),
           nb::arg("threads") = 1)
      .def_prop_ro("num_envs", &NativeReference::num_envs)
      .def("spec", &NativeReference::Spec)
      .def("reset", &NativeReference::Reset, nb::arg("seed"))
      .def("step", &NativeReference::Step, nb::arg("actions"));
  nb::class_<sandwright::ShapingEnv::State>(module, "State");
  nb::class_<NativeEnv>(module, "NativeEnv")
      .def(nb::init<const std::string&, const std::string&>(), nb::arg("config_json"),
           nb::arg("autoreset"))
      .def_prop_ro("num_envs", &NativeEnv::num_envs)
      .def("config", &NativeEnv::config)
      .def("spec", &NativeEnv::Spec)
      .def("reset", &NativeEnv::Reset, nb::arg("seed"))
      .def("reset_rows", &NativeEnv::ResetRows, nb::arg("chosen"), nb::arg("seeds"))
      .def("step",
           nb::overload_cast<const nb::ndarray<const float, nb::ndim<2>, nb::c_contig>&>(&NativeEnv::Step),
           nb::arg("actions"))
      .def("step_cells", &NativeEnv::StepCells, nb::arg("choices"))
      .def("start_masks", &NativeEnv::StartMasks)
      .def("save", &NativeEnv::Save)
      .def("restore", &NativeEnv::Restore, nb::arg("state"))
      .def("maps", &NativeEnv::Maps, nb::arg("row"))
      .def("render", &NativeEnv::Render, nb::arg("row"), nb::arg("height_px"));
}
