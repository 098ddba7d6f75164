// Runs a parsed program, a turn a control period.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/controller_fake/script_machine.h"
#include "tests/support/controller_fake/script_parser.h"
#include "tests/support/controller_fake/script_thread.h"

namespace sandwright::fake {

// Ends the whole program (`halt`, or an operator's no).
struct ProgramHalted {};

class ScriptRunner {
 public:
  ScriptRunner(ScriptMachine& machine, ScriptProgram program);
  ~ScriptRunner();
  ScriptRunner(const ScriptRunner&) = delete;
  ScriptRunner& operator=(const ScriptRunner&) = delete;

  const ScriptProgram& program() const { return program_; }
  ScriptMachine& machine() { return machine_; }
  bool finished() const { return finished_; }
  // What ended the program before its end, if something did.
  const std::optional<ScriptFault>& fault() const { return fault_; }
  // Every thread once; none once the program has ended.
  void Turn();
  // Unwinds all threads.
  void Stop();

  // For the threads.
  std::map<std::string, Value>& globals() { return globals_; }
  ThreadHandle Run(const std::string& thread);
  void Kill(int id);
  bool Alive(int id) const;
  // One thread at a time moves the arm; throws ScriptError where another does.
  void ClaimArm(int thread);
  void ReleaseArm() { arm_owner_.reset(); }
  bool ArmClaimed() const { return arm_owner_.has_value(); }
  void EnterCritical(int thread) { critical_ = thread; }
  void ExitCritical() { critical_.reset(); }

 private:
  void Add(const ScriptFunction& function);

  ScriptMachine& machine_;
  ScriptProgram program_;
  std::map<std::string, Value> globals_;
  std::vector<std::unique_ptr<ScriptThread>> threads_;  // the first is the main one
  std::optional<int> arm_owner_, critical_;
  bool finished_ = false;
  std::optional<ScriptFault> fault_;
  int next_id_ = 1;
};

}  // namespace sandwright::fake
