#include "cli/watch.h"

#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <mutex>

#include "cli/live_page.h"
#include "data/base/atomic_file.h"

namespace sandwright {
namespace {

// What the program warns of, wherever in it.
class WarningSink final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  explicit WarningSink(RunStatus& status) : status_(status) { set_level(spdlog::level::warn); }

 private:
  void sink_it_(const spdlog::details::log_msg& message) override {
    status_.Warn(std::string(message.payload.data(), message.payload.size()));
  }
  void flush_() override {}

  RunStatus& status_;
};

}  // namespace

Watch::Watch(const std::string& command, const std::filesystem::path& output, bool folder)
    : output_(output),
      folder_(folder),
      status_(command, [this](const RunReport& report) { Write(report); }),
      warnings_(std::make_shared<WarningSink>(status_)) {
  spdlog::default_logger()->sinks().push_back(warnings_);
}

Watch::~Watch() { std::erase(spdlog::default_logger()->sinks(), warnings_); }

void Watch::Write(const RunReport& report) const {
  const auto file = [&](const char* name) {
    return folder_ ? output_ / name : std::filesystem::path(output_.string() + "." + name);
  };
  WriteFileAtomically(file("status.json"), report.ToJson().dump(2) + "\n");
  WriteFileAtomically(file("live.html"), RenderLivePage(report));
}

}  // namespace sandwright
