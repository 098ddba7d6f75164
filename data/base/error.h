// The one exception type, and the check for programmer errors.
#pragma once

#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace sandwright {

// What went wrong, as far as a caller (and the exit code) must tell it apart.
enum class ErrorKind {
  kInternal,     // a bug: exit 1
  kBadInput,     // a file, key, flag or device is not what is allowed: exit 2
  kRefused,      // well-formed input that must not be used (not sand, unsafe): exit 3
  kInterrupted,  // the user stopped the run: exit 130
};

// Message form for users: what, where (file or key), the value, what is allowed.
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& message, ErrorKind kind = ErrorKind::kBadInput)
      : std::runtime_error(message), kind_(kind) {}
  // A refusal with one entry per reason; `what()` joins them.
  Error(const std::string& subject, std::vector<std::string> reasons)
      : std::runtime_error(Join(subject, reasons)),
        kind_(ErrorKind::kRefused),
        reasons_(std::move(reasons)) {}

  ErrorKind kind() const { return kind_; }
  const std::vector<std::string>& reasons() const { return reasons_; }

 private:
  static std::string Join(const std::string& subject, const std::vector<std::string>& reasons) {
    std::string text = subject;
    for (const auto& reason : reasons) text += "\n  - " + reason;
    return text;
  }

  ErrorKind kind_;
  std::vector<std::string> reasons_;
};

namespace internal {
template <class... Values>
[[noreturn]] void FailCheck(const char* condition, const char* file, int line,
                            const Values&... values) {
  std::ostringstream text;
  text << file << ":" << line << ": check failed: " << condition;
  ((text << " [" << values << "]"), ...);
  throw Error(text.str(), ErrorKind::kInternal);
}
}  // namespace internal

}  // namespace sandwright

// Guards against programmer errors, alive in Release; prints the values that follow.
#define SAND_CHECK(condition, ...)                                            \
  do {                                                                        \
    if (!(condition))                                                         \
      ::sandwright::internal::FailCheck(#condition, __FILE__,                 \
                                        __LINE__ __VA_OPT__(, ) __VA_ARGS__); \
  } while (false)
