// A thread of a program: a thread of the machine that runs only while it is given a turn, so that
// the program's threads take turns once a control period as on the controller.
#pragma once

#include <exception>
#include <functional>
#include <semaphore>
#include <thread>

namespace sandwright::fake {

// Unwinds a thread that has been killed.
struct ThreadKilled {};

class ScriptThread {
 public:
  ScriptThread(int id, std::function<void(ScriptThread&)> body);
  // Kills it first.
  ~ScriptThread();

  int id() const { return id_; }
  bool finished() const { return finished_; }
  // Lets it run until it yields or ends; rethrows what it threw.
  void Turn();
  // Unwinds it, unless it is the caller itself, which goes on until it next yields.
  void Kill();
  // By the thread itself: the period is over for it. With `awaited`, the next turns go by until it
  // holds, which is cheaper than to wake the thread for each look.
  void Yield(std::function<bool()> awaited = {});

 private:
  void Hand();

  int id_;
  bool finished_ = false, killed_ = false, running_ = false;
  std::function<bool()> awaited_;
  std::exception_ptr thrown_;
  std::binary_semaphore go_{0}, back_{0};
  std::thread worker_;
};

}  // namespace sandwright::fake
