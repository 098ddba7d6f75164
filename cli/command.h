// What all subcommands share: common flags, configuration, results, exit codes.
//
// A subcommand is one small file with one class:
//
//   class ScanCommand final : public Command {
//     void Declare(CLI::App& app) override { app.add_option("--depth", depth_, "frames"); }
//     void Fields(FieldList& f) override { f.Section("scan", config_); }
//     int Run() override { ...; WriteResult({{"accepted", true}}); return 0; }
//   };
//   std::unique_ptr<Command> MakeScanCommand() { return std::make_unique<ScanCommand>(); }
//
// and one line in the table of cli/main.cc.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/notify.h"
#include "cli/watch.h"
#include "data/base/config.h"

namespace sandwright {

class Command {
 public:
  virtual ~Command() = default;

  virtual void Declare(CLI::App& app) = 0;  // the subcommand's own flags
  virtual void Fields(FieldList&) {}        // its configuration keys
  virtual int Run() = 0;                    // returns the exit code; throws Error

  // Adds --config, --seed, --threads, --json and the help of the keys.
  void DeclareCommon(CLI::App& app);
  // The configuration that is read where --config is not given; "": none.
  virtual std::string DefaultConfigFile() const { return ""; }
  // --config FILE (or the default one), then the dotted overrides in order.
  void Configure(const std::vector<std::string>& overrides);
  // The --json file for a refusal that was thrown.
  void WriteRefusal(const std::vector<std::string>& reasons) const;
  // How it ended, `fault` being what was thrown: for the files of a run that watches itself, and
  // for notify.command.
  void Finish(int exit_code, const std::string& fault);

 protected:
  uint64_t seed() const { return seed_; }
  int threads() const { return threads_; }
  const std::string& config_file() const { return config_file_; }  // "" where none was given
  // `result` with command, config (resolved), seed, threads, version, commit and machine.
  nlohmann::json WithRun(nlohmann::json result) const;
  // Writes that to the --json file where one was asked for.
  void WriteResult(const nlohmann::json& result) const;
  // Of a subcommand that runs for hours: the keys `notify`; and from here on status.json and
  // live.html in (or beside) what it makes.
  void UnattendedFields(FieldList& f) { f.Section("notify", notify_); }
  RunStatus* WatchFolder(const std::string& folder);
  RunStatus* WatchFile(const std::string& file);
  // The outcome in a line, on standard output and for whoever is told of the end.
  void Say(const std::string& outcome);
  // From here on another process speaks for this one: nothing is said, written or notified.
  void LeaveItToAnother() { silent_ = true; }
  // The resolved configuration of this run.
  nlohmann::json ResolvedConfig() const;

 private:
  FieldList fields_;
  std::string name_, config_file_, json_file_, outcome_;
  NotifyConfig notify_;
  std::unique_ptr<Watch> watch_;
  uint64_t seed_ = 0;
  int threads_ = 0;
  bool silent_ = false;
};

// Registered in cli/main.cc, each defined in cli/<name>.cc.
std::unique_ptr<Command> MakeScanCommand();
std::unique_ptr<Command> MakeCollectCommand();
std::unique_ptr<Command> MakeFitCommand();
std::unique_ptr<Command> MakeScoreCommand();
std::unique_ptr<Command> MakePromoteCommand();
std::unique_ptr<Command> MakeSimulateCommand();
std::unique_ptr<Command> MakeTrainCommand();
std::unique_ptr<Command> MakeEvalCommand();
std::unique_ptr<Command> MakeTasksCommand();
std::unique_ptr<Command> MakePlotCommand();
std::unique_ptr<Command> MakePlanCommand();
std::unique_ptr<Command> MakeCalibrateKinematicsCommand();
std::unique_ptr<Command> MakeCalibrateHandEyeCommand();
std::unique_ptr<Command> MakeCalibrateToolCommand();
std::unique_ptr<Command> MakeCalibrateBoxCommand();
std::unique_ptr<Command> MakeWorkcellCommand();
std::unique_ptr<Command> MakeCheckCommand();
std::unique_ptr<Command> MakeExportCommand();
std::unique_ptr<Command> MakeDeployCommand();
std::unique_ptr<Command> MakeBenchCommand();
std::unique_ptr<Command> MakeDemoCommand();
std::unique_ptr<Command> MakeConvertCommand();
std::unique_ptr<Command> MakeGoalCommand();

}  // namespace sandwright
