// Independent work over threads. Each index writes only its own results, so the outcome does not
// depend on the thread count.
#pragma once

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace sandwright {

// Calls body(i) for i in [0, count) on up to `threads` threads (the caller's is one of them).
// The first exception is rethrown after all threads have stopped.
template <class Body>
void ParallelFor(int count, int threads, const Body& body) {
  threads = std::clamp(threads, 1, std::max(count, 1));
  std::atomic<int> next{0};
  std::exception_ptr failure;
  std::mutex failure_mutex;
  auto work = [&] {
    for (int i; (i = next++) < count;) {
      try {
        body(i);
      } catch (...) {
        const std::lock_guard lock(failure_mutex);
        if (!failure) failure = std::current_exception();
        next = count;
      }
    }
  };
  {
    std::vector<std::jthread> helpers;
    for (int t = 1; t < threads; ++t) helpers.emplace_back(work);
    work();
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace sandwright
