#include "agents/kept_evaluation.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include "agents/trainer.h"
#include "data/base/error.h"
#include "data/base/hdf5.h"
#include "data/base/stop.h"
#include "data/stroke_dataset.h"
#include "env/dem.h"
#include "env/grains.h"

namespace sandwright {
namespace {

constexpr int kChoices = 10;  // of a stroke, where grains get lost
// Settling grains is dear, and each bed is carved anew: tasks take turns with so many packings.
constexpr size_t kPackings = 3;

// What the strokes of a task cost.
struct Cost {
  double agent_s = 0, world_s = 0;
  int64_t model_evaluations = 0;
};

// The strokes of one task on disk, and the bed that they left.
class KeptTask {
 public:
  // Throws Error where what is there has other settings, or the file of its grains is gone.
  KeptTask(const std::filesystem::path& folder, size_t index, const Task& task, StrokeFile head)
      : folder_(folder), name_(fmt::format("task_{:05}", index)), task_(task), content_(std::move(head)) {
    if (!std::filesystem::exists(File())) return;
    StrokeFile found = ReadStrokeFile(File());
    CheckSettings(nlohmann::json::parse(found.material, nullptr, false));
    content_ = std::move(found);
    ReadBed();
  }

  const std::vector<StrokeRecord>& strokes() const { return content_.strokes; }
  const Cost& cost() const { return cost_; }
  // As the last stroke left it; none before the first.
  const std::optional<SandState>& bed() const { return bed_; }

  // The bed first: strokes on file always have what the next one needs.
  void Add(StrokeRecord record, SandState after, const Cost& cost) {
    bed_ = std::move(after);
    cost_.agent_s += cost.agent_s;
    cost_.world_s += cost.world_s;
    cost_.model_evaluations += cost.model_evaluations;
    record.step = static_cast<int64_t>(content_.strokes.size());
    content_.strokes.push_back(std::move(record));
    WriteHdf5(BedFile(content_.strokes.size()), [&](H5::H5File& h5) {
      WriteNumber(h5, "agent_s", cost_.agent_s);
      WriteNumber(h5, "world_s", cost_.world_s);
      WriteInteger(h5, "model_evaluations", cost_.model_evaluations);
      if (bed_->grains()) WriteGrains(bed_->grains()->grains, h5);
    });
    WriteStrokeFile(content_, File());
    std::filesystem::remove(BedFile(content_.strokes.size() - 1));
  }

 private:
  std::filesystem::path File() const { return folder_ / (name_ + ".h5"); }
  std::filesystem::path BedFile(size_t strokes) const {
    return folder_ / fmt::format(".{}_{:05}.bed", name_, strokes);
  }

  void CheckSettings(const nlohmann::json& found) const {
    const auto wanted = nlohmann::json::parse(content_.material);
    if (found == wanted) return;
    const std::string where = nlohmann::json::diff(found, wanted).front()["path"];
    const nlohmann::json::json_pointer at(where);
    throw Error(fmt::format("{}: its strokes are kept with other settings than asked for (the first: {} is {} there): "
                            "choose another folder",
                            File().string(), where, found.contains(at) ? found.at(at).dump() : "not"));
  }

  void ReadBed() {
    const std::filesystem::path file = BedFile(content_.strokes.size());
    if (!std::filesystem::exists(file))
      throw Error(fmt::format("{}: {}, which keeps the bed after its {} strokes, is gone: choose another folder",
                              File().string(), file.filename().string(), content_.strokes.size()));
    const std::string where = file.string();
    const H5::H5File h5 = OpenHdf5(file);
    cost_ = {ReadNumber(h5, "agent_s", where), ReadNumber(h5, "world_s", where),
             ReadInteger(h5, "model_evaluations", where)};
    std::shared_ptr<const GrainBed> grains;
    if (HasDataset(h5, "grains_m"))
      grains = std::make_shared<const GrainBed>(
          GrainBed{task_.terrain.width_m(), task_.terrain.depth_m(), ReadGrains(h5, where)});
    bed_ = SandState(content_.strokes.back().after, std::move(grains));
  }

  std::filesystem::path folder_;
  std::string name_;
  const Task& task_;
  StrokeFile content_;
  std::optional<SandState> bed_;
  Cost cost_;
};

class KeptRun {
 public:
  KeptRun(Agent& agent, const World& world, const EpisodeConfig& config, uint64_t seed, const KeptIn& kept,
          const std::function<void(int64_t)>& progress)
      : agent_(agent), world_(world), config_(config), seed_(seed), kept_(kept), progress_(progress) {
    result_.agent = agent.name();
    result_.world = world.sand.name();
  }

  Evaluation Go(std::span<const Task> tasks) {
    for (size_t i = 0; i < tasks.size() && !result_.stopped; ++i) Play(i, tasks[i]);
    return std::move(result_);
  }

 private:
  RandomStream StreamOf(std::string_view purpose, size_t index, size_t stroke) const {
    return RandomStream(seed_, StreamId(purpose), static_cast<uint64_t>(index) << 32 | stroke);
  }

  StrokeFile HeadOf(size_t index, const Task& task) const {
    nlohmann::json settings = kept_.settings;
    EpisodeConfig config = config_;
    settings["episode"] = ToJson(FieldsOf(config));
    settings["seed"] = seed_;
    const std::string task_sha256 = TasksSha256({task});
    settings["task_sha256"] = task_sha256;
    // Agents on one task begin on one bed.
    return {result_.world, fmt::format("task_{}_{}_{:05}", task_sha256.substr(0, 8), seed_, index),
            static_cast<int64_t>(seed_), settings.dump(), {}};
  }

  // The episode after the strokes on file. Made anew for each stroke, so that a run that was stopped goes on
  // as one that was not.
  EpisodeState EpisodeOf(size_t index, const std::shared_ptr<const Task>& task, const KeptTask& on_file,
                         const SandState& bed) const {
    const std::vector<StrokeRecord>& strokes = on_file.strokes();
    std::vector<double> error_m = {GoalError(strokes.empty() ? bed.map() : strokes[0].before, task->goal)};
    double moved_m3 = 0;
    for (const StrokeRecord& done : strokes) {
      error_m.push_back(GoalError(done.after, task->goal));
      moved_m3 += MovedVolume(done.before, done.after, {0, 0, done.after.rows, done.after.columns});
    }
    EpisodeState episode = ContinueEpisode(task, config_, bed, std::move(error_m),
                                           StreamOf("kept evaluation noise", index, strokes.size()));
    episode.moved_volume_m3 = moved_m3;
    return episode;
  }

  // Until the task ends or somebody stops it.
  void Play(size_t index, const Task& given) {
    const auto task = std::make_shared<const Task>(given);
    KeptTask on_file(kept_.folder, index, *task, HeadOf(index, *task));
    strokes_ += static_cast<int64_t>(on_file.strokes().size());
    std::optional<SandState> bed = on_file.bed();
    try {
      if (!bed)
        bed = world_.sand.Start(task->terrain, StreamOf("kept evaluation bed", index % kPackings, 0).Next64());
      for (;;) {
        EpisodeState episode = EpisodeOf(index, task, on_file, *bed);
        if (episode.ended()) break;
        ThrowIfStopRequested();
        Step(index, std::move(episode), on_file);
        bed = on_file.bed();
        if (progress_) progress_(++strokes_);
      }
    } catch (const Error& e) {
      if (e.kind() != ErrorKind::kInterrupted) throw;
      result_.stopped = true;
    }
    if (!bed) bed = SandState(task->terrain);  // stopped before there was one
    const EpisodeState end = EpisodeOf(index, task, on_file, *bed);
    result_.per_task.push_back(EpisodeMetrics(end, config_));
    result_.end.push_back(end.sand.map());
    result_.strokes += end.strokes();
    result_.agent_s += on_file.cost().agent_s;
    result_.world_s += on_file.cost().world_s;
    result_.model_evaluations += static_cast<double>(on_file.cost().model_evaluations);
  }

  void Step(size_t index, EpisodeState episode, KeptTask& on_file) {
    RandomStream stream = StreamOf("kept evaluation actions", index, on_file.strokes().size());
    Cost cost;
    const int64_t evaluations_before = agent_.model_evaluations();
    for (int choice = 0;; ++choice) {
      episode.rejected_in_a_row = choice;
      const TaskView view = View(episode);
      auto start = Clock::now();
      const Action action = agent_.Act({&view, 1}, {&stream, 1}).front();
      cost.agent_s += SecondsSince(start);
      cost.model_evaluations = agent_.model_evaluations() - evaluations_before;
      const HeightMap before = episode.sand.map();
      start = Clock::now();
      try {
        const auto result = StepEpisodes(world_, config_, {&episode, 1}, {&action, 1}).front();
        cost.world_s += SecondsSince(start);
        StrokeRecord record;
        record.before = before;
        record.after = episode.sand.map();
        record.stroke = result->stroke;
        record.path = SamplePath(result->stroke, before.cell_size_m / 2);
        record.blade = world_.sand.blade();
        spdlog::info("{}: task {}, stroke {}: {:.2f} mm, {:.1f} s of {}", agent_.name(), index,
                     on_file.strokes().size() + 1, 1e3 * episode.goal_error_m.back(), SecondsSince(start),
                     world_.sand.name());
        on_file.Add(std::move(record), episode.sand, cost);
        return;
      } catch (const GrainsLost& e) {
        cost.world_s += SecondsSince(start);
        if (choice + 1 == kChoices) throw;
        spdlog::warn("{}: task {}: {}; another stroke is chosen", agent_.name(), index, e.what());
      }
    }
  }

  Agent& agent_;
  const World& world_;
  const EpisodeConfig& config_;
  uint64_t seed_;
  const KeptIn& kept_;
  const std::function<void(int64_t)>& progress_;
  int64_t strokes_ = 0;
  Evaluation result_;
};

}  // namespace

Evaluation EvaluateKept(Agent& agent, const World& world, const EpisodeConfig& config,
                        std::span<const Task> tasks, uint64_t seed, const KeptIn& kept,
                        const std::function<void(int64_t)>& progress) {
  SAND_CHECK(!world.gate);
  if (tasks.empty()) throw Error("no tasks to evaluate on");
  if (config.tracking_error_m > 0)
    throw Error(fmt::format("tracking_error_m = {}: strokes are kept as they were executed; must be 0 here",
                            config.tracking_error_m));
  std::error_code failure;
  std::filesystem::create_directories(kept.folder, failure);
  if (failure) throw Error("cannot make folder " + kept.folder.string() + ": " + failure.message());
  return KeptRun(agent, world, config, seed, kept, progress).Go(tasks);
}

}  // namespace sandwright
