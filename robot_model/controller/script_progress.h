// What the controller has said about one script that was sent to it.
#pragma once

#include <optional>
#include <string>

#include "robot_model/controller/primary.h"

namespace sandwright {

// Fed with every message since the script was sent.
class ScriptProgress {
 public:
  explicit ScriptProgress(std::string name) : name_(std::move(name)) {}

  void Take(const PrimaryItem& item);

  bool started() const { return started_; }
  bool stopped() const { return stopped_; }  // after it had started
  // A runtime exception or syntax error, with line and column; none so far.
  const std::optional<std::string>& exception() const { return exception_; }
  // An error of level violation or fault.
  const std::optional<std::string>& controller_error() const { return controller_error_; }
  // The name of another program that was started.
  const std::optional<std::string>& foreign() const { return foreign_; }
  const std::string& last_text() const { return last_text_; }  // of textmsg or a popup

 private:
  void TakeKey(const KeyMessage& key);

  std::string name_;
  bool started_ = false, stopped_ = false;
  std::optional<std::string> exception_, controller_error_, foreign_;
  std::string last_text_;
};

}  // namespace sandwright
