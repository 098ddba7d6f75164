#include "data/base/machine.h"

#include <fstream>
#include <thread>

#include "build_version.h"  // generated: SANDWRIGHT_VERSION, SANDWRIGHT_COMMIT

namespace sandwright {

std::string BuildVersion() { return SANDWRIGHT_VERSION; }
std::string BuildCommit() { return SANDWRIGHT_COMMIT; }

nlohmann::json MachineDescription() {
  std::string cpu = "unknown";
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (line.starts_with("model name")) {
      cpu = line.substr(line.find(':') + 2);
      break;
    }
  }
  std::string isa;
#if defined(__x86_64__)
  const auto add = [&](bool has, const char* name) {
    if (has) isa += (isa.empty() ? "" : " ") + std::string(name);
  };
  add(__builtin_cpu_supports("avx2"), "avx2");
  add(__builtin_cpu_supports("fma"), "fma");
  add(__builtin_cpu_supports("avx512f"), "avx512f");
#endif
  return {{"cpu", cpu}, {"threads", std::thread::hardware_concurrency()}, {"isa", isa}};
}

}  // namespace sandwright
