#include "agents/mpi_collective.h"

#include <mpi.h>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "data/base/error.h"
#include "data/base/stop.h"

namespace sandwright {
namespace {

using Clock = std::chrono::steady_clock;

// Every call is started without waiting and asked for until it is done, so that a rank that is gone
// is noticed. Buffers are members: a call that was given up may still write into them.
class MpiCollective final : public Collective {
 public:
  MpiCollective(int rank, int size, double lost_after_s)
      : Collective(rank, size), lost_after_s_(lost_after_s) {}

  // Each rank adds up its part of the numbers, of which all send it theirs, and sends the sums to
  // all: as few bytes as a ring, and the order of the sum is ours, not that of the MPI library's choice.
  void Sum(std::span<float> numbers) override {
    const size_t ranks = static_cast<size_t>(size());
    const size_t part = (numbers.size() + ranks - 1) / ranks;
    mine_.assign(numbers.begin(), numbers.end());
    mine_.resize(part * ranks);
    theirs_.resize(part * ranks);
    sums_.resize(part);
    const int count = static_cast<int>(part);
    Await("a sum", [&](MPI_Request* request) {
      return MPI_Ialltoall(mine_.data(), count, MPI_FLOAT, theirs_.data(), count, MPI_FLOAT,
                           MPI_COMM_WORLD, request);
    });
    for (size_t i = 0; i < part; ++i) {
      double sum = 0;
      for (size_t rank = 0; rank < ranks; ++rank) sum += theirs_[rank * part + i];
      sums_[i] = static_cast<float>(sum);
    }
    Await("a sum", [&](MPI_Request* request) {
      return MPI_Iallgather(sums_.data(), count, MPI_FLOAT, mine_.data(), count, MPI_FLOAT,
                            MPI_COMM_WORLD, request);
    });
    std::copy_n(mine_.begin(), numbers.size(), numbers.begin());
  }

  std::vector<std::byte> Gather(std::span<const std::byte> mine) override {
    sent_.assign(mine.begin(), mine.end());
    gathered_.resize(mine.size() * static_cast<size_t>(size()));
    const int count = static_cast<int>(mine.size());
    SAND_CHECK(static_cast<size_t>(count) == mine.size(), mine.size());
    Await("an exchange", [&](MPI_Request* request) {
      return MPI_Iallgather(sent_.data(), count, MPI_BYTE, gathered_.data(), count, MPI_BYTE,
                            MPI_COMM_WORLD, request);
    });
    return gathered_;
  }

  // At once: the launcher asks all to stop, gives them a second, and ends them.
  void CheckIn() override { ThrowIfStopRequested(); }

  void Leave() override {
    Await("the end", [](MPI_Request* request) { return MPI_Ibarrier(MPI_COMM_WORLD, request); });
    MPI_Finalize();
  }

 private:
  template <class Start>
  void Await(const char* what, const Start& start) {
    CheckIn();
    MPI_Request request = MPI_REQUEST_NULL;
    if (start(&request) != MPI_SUCCESS) Lose(what);
    const auto began = Clock::now();
    for (int polls = 0;; ++polls) {
      int done = 0;
      if (MPI_Test(&request, &done, MPI_STATUS_IGNORE) != MPI_SUCCESS) Lose(what);
      if (done) return;
      CheckIn();
      if (std::chrono::duration<double>(Clock::now() - began).count() > lost_after_s_) Lose(what);
      constexpr int kSpins = 1000;  // then the core is another's, if one wants it
      if (polls > kSpins) std::this_thread::yield();
    }
  }

  [[noreturn]] void Lose(const char* what) const {
    throw Error(fmt::format("rank {} of {}: another rank is lost: no answer within {:g} s to {}",
                            rank(), size(), lost_after_s_, what));
  }

  double lost_after_s_;
  std::vector<float> mine_, theirs_, sums_;
  std::vector<std::byte> sent_, gathered_;
};

}  // namespace

std::shared_ptr<Collective> JoinMpi(int launched, double lost_after_s) {
  int threads = 0, rank = 0, size = 0;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &threads);
  MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  if (size != launched)
    throw Error(fmt::format("{} processes were started together, and MPI sees {}: the launcher is not "
                            "that of the MPI which this program was built with", launched, size));
  return std::make_shared<MpiCollective>(rank, size, lost_after_s);
}

}  // namespace sandwright
