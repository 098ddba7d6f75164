#include "cli/command.h"

#include <cstdio>
#include <thread>

#include "data/base/atomic_file.h"
#include "data/base/machine.h"

namespace sandwright {

void Command::DeclareCommon(CLI::App& app) {
  name_ = app.get_name();
  const CLI::App* group = app.get_parent();
  if (group->get_parent()) name_ = group->get_name() + " " + name_;
  threads_ = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  app.add_option("--config", config_file_, "configuration (YAML)")->check(CLI::ExistingFile);
  app.add_option("--seed", seed_, "seed of every random stream")->capture_default_str();
  app.add_option("--threads", threads_, "worker threads")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  app.add_option("--json", json_file_, "write the result here (JSON, keys with units)");
  Fields(fields_);
  const std::string keys = Help(fields_);
  if (!keys.empty())
    app.footer("Configuration keys, in --config or behind the flags as key=value:\n" + keys);
}

void Command::Configure(const std::vector<std::string>& overrides) {
  const std::string file = config_file_.empty() ? DefaultConfigFile() : config_file_;
  if (!file.empty()) LoadYaml(fields_, file);
  ApplyOverrides(fields_, overrides);
  // An hour of work must not end at a folder that is not there.
  if (!json_file_.empty()) AtomicFile{json_file_};
}

nlohmann::json Command::ResolvedConfig() const { return ToJson(fields_); }

nlohmann::json Command::WithRun(nlohmann::json result) const {
  result["command"] = name_;
  result["config"] = ResolvedConfig();
  if (!result.contains("seed")) result["seed"] = seed_;
  if (!result.contains("threads")) result["threads"] = threads_;
  result["version"] = BuildVersion();
  result["commit"] = BuildCommit();
  result["machine"] = MachineDescription();
  return result;
}

void Command::WriteResult(const nlohmann::json& result) const {
  if (!json_file_.empty() && !silent_) WriteFileAtomically(json_file_, WithRun(result).dump(2) + "\n");
}

RunStatus* Command::WatchFolder(const std::string& folder) {
  watch_ = std::make_unique<Watch>(name_, folder, true);
  return &watch_->status();
}

RunStatus* Command::WatchFile(const std::string& file) {
  watch_ = std::make_unique<Watch>(name_, file, false);
  return &watch_->status();
}

void Command::Say(const std::string& outcome) {
  if (!silent_) std::printf("%s\n", outcome.c_str());
  outcome_ = outcome;
}

void Command::Finish(int exit_code, const std::string& fault) {
  if (silent_) return;
  const RunState state = exit_code == 0     ? RunState::kDone
                         : exit_code == 130 ? RunState::kStopped
                         : exit_code == 3   ? RunState::kRefused
                                            : RunState::kFailed;
  const std::string text = fault.empty() ? outcome_ : fault;
  if (watch_) watch_->status().End(state, text);
  Notify(notify_, NameOf(state), text, watch_ ? watch_->output().string() : "");
}

void Command::WriteRefusal(const std::vector<std::string>& reasons) const {
  WriteResult({{"accepted", false}, {"reasons", reasons}});
}

}  // namespace sandwright
