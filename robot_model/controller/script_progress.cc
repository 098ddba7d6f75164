#include "robot_model/controller/script_progress.h"

#include <spdlog/fmt/fmt.h>

namespace sandwright {
namespace {

constexpr int32_t kReadOnlyInterface = 210;  // the error code

}  // namespace

void ScriptProgress::Take(const PrimaryItem& item) {
  if (const auto* key = std::get_if<KeyMessage>(&item)) TakeKey(*key);
  if (const auto* text = std::get_if<TextMessage>(&item)) last_text_ = text->text;
  if (const auto* popup = std::get_if<PopupMessage>(&item)) last_text_ = popup->text;
  if (const auto* thrown = std::get_if<RuntimeExceptionMessage>(&item); thrown && !exception_)
    exception_ = fmt::format("line {}, column {}: {}", thrown->line, thrown->column, thrown->text);
  const auto* error = std::get_if<ErrorCodeMessage>(&item);
  if (!error || controller_error_) return;
  if (error->code == kReadOnlyInterface)
    controller_error_ = "C210: the interface is read-only, the script was not taken";
  else if (error->is_serious())
    controller_error_ = fmt::format("C{}A{}: {}", error->code, error->argument, error->text);
}

void ScriptProgress::TakeKey(const KeyMessage& key) {
  if (key.title == "PROGRAM_XXX_STARTED") {
    if (key.text == name_ && !started_) started_ = true;
    // The same name once more is another program too: we send each script once.
    else foreign_ = key.text;
  } else if (key.title == "PROGRAM_XXX_STOPPED" && key.text == name_) {
    stopped_ = started_;
  }
}

}  // namespace sandwright
