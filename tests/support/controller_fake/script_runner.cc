#include "tests/support/controller_fake/script_runner.h"

#include <algorithm>

#include "tests/support/controller_fake/script_evaluator.h"

namespace sandwright::fake {

ScriptRunner::ScriptRunner(ScriptMachine& machine, ScriptProgram program)
    : machine_(machine), program_(std::move(program)) {
  Add(program_.main);
}

ScriptRunner::~ScriptRunner() { Stop(); }

void ScriptRunner::Add(const ScriptFunction& function) {
  threads_.push_back(std::make_unique<ScriptThread>(next_id_++, [this, &function](ScriptThread& t) {
    ScriptEvaluator(*this, t, &function == &program_.main).Run(function);
  }));
}

void ScriptRunner::Turn() {
  if (finished_) return;
  try {
    // A thread that is started in a turn has its first in the same one.
    for (size_t i = 0; i < threads_.size(); ++i) {
      if (!critical_ || *critical_ == threads_[i]->id()) threads_[i]->Turn();
    }
    if (!threads_.front()->finished()) {
      std::erase_if(threads_, [&](const auto& thread) {
        return thread != threads_.front() && thread->finished();
      });
      return;
    }
  } catch (const ProgramHalted&) {
  } catch (const ScriptFault& fault) {
    fault_ = fault;
  }
  Stop();
}

void ScriptRunner::Stop() {
  finished_ = true;
  for (auto& thread : threads_) thread->Kill();
}

ThreadHandle ScriptRunner::Run(const std::string& thread) {
  const auto found = program_.functions.find(thread);
  if (found == program_.functions.end() || !found->second.is_thread)
    throw ScriptError("no thread is called " + thread);
  Add(found->second);
  return {threads_.back()->id()};
}

void ScriptRunner::Kill(int id) {
  for (auto& thread : threads_) {
    if (thread->id() == id) thread->Kill();
  }
  if (critical_ == id) critical_.reset();
}

bool ScriptRunner::Alive(int id) const {
  return std::ranges::any_of(
      threads_, [&](const auto& thread) { return thread->id() == id && !thread->finished(); });
}

void ScriptRunner::ClaimArm(int thread) {
  if (arm_owner_ && *arm_owner_ != thread)
    throw ScriptError("another thread is already controlling the robot");
  arm_owner_ = thread;
}

}  // namespace sandwright::fake
