#include "tests/support/controller_fake/script_thread.h"

#include <utility>

namespace sandwright::fake {

ScriptThread::ScriptThread(int id, std::function<void(ScriptThread&)> body)
    : id_(id), worker_([this, body = std::move(body)] {
        go_.acquire();
        try {
          if (!killed_) body(*this);
        } catch (const ThreadKilled&) {
        } catch (...) {
          thrown_ = std::current_exception();
        }
        finished_ = true;
        back_.release();
      }) {}

ScriptThread::~ScriptThread() {
  Kill();
  worker_.join();
}

void ScriptThread::Hand() {
  running_ = true;
  go_.release();
  back_.acquire();
  running_ = false;
}

void ScriptThread::Turn() {
  if (finished_ || (awaited_ && !awaited_())) return;
  awaited_ = {};
  Hand();
  if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
}

void ScriptThread::Kill() {
  killed_ = true;
  if (!finished_ && !running_) Hand();
}

void ScriptThread::Yield(std::function<bool()> awaited) {
  awaited_ = std::move(awaited);
  back_.release();
  go_.acquire();
  if (killed_) throw ThreadKilled{};
}

}  // namespace sandwright::fake
