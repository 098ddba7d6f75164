// What the processes of one training run ("ranks") say to each other. All of them call the same
// functions in the same order.
#pragma once

#include <cstddef>
#include <cstring>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace sandwright {

class Collective {
 public:
  virtual ~Collective() = default;
  int rank() const { return rank_; }
  int size() const { return size_; }
  bool leads() const { return rank_ == 0; }  // writes the run folder and speaks for all

  // Each number becomes its sum over the ranks, added in their order: the same bytes on all.
  virtual void Sum(std::span<float> numbers) = 0;
  // `mine`, as long on every rank, of all ranks in their order.
  virtual std::vector<std::byte> Gather(std::span<const std::byte> mine) = 0;
  // Called between the others in long work: throws Error (kInterrupted) where a stop was asked for and
  // cannot wait for the end of an update.
  virtual void CheckIn() = 0;
  // This rank's work is done; one that ends without is lost to the others.
  virtual void Leave() = 0;

 protected:
  Collective(int rank, int size) : rank_(rank), size_(size) {}

 private:
  int rank_, size_;
};

// The only rank of a run.
Collective& Alone();

// `mine`, as long on every rank, of all ranks in their order.
template <class T>
std::vector<T> GatherAll(Collective& ranks, std::span<const T> mine) {
  const std::vector<std::byte> bytes = ranks.Gather(std::as_bytes(mine));
  std::vector<T> all(bytes.size() / sizeof(T));
  std::memcpy(all.data(), bytes.data(), bytes.size());
  return all;
}

// One text a rank, of any length.
std::vector<std::string> GatherTexts(Collective& ranks, const std::string& mine);

// Of T steps of N environments a rank, `width` numbers each, step-major: those of all environments,
// [T, ranks * N, width] out of [T, N, width].
std::vector<float> GatherSteps(Collective& ranks, std::span<const float> mine, size_t envs,
                               size_t width);

// Does `work`, which must not call `ranks`. Where it throws Error on any rank, all leave and throw
// that of the first such rank, which is named; only the leader logs it.
void AllOrNone(Collective& ranks, const std::function<void()>& work);

// Throws Error on all ranks, of which only the leader logs it, where something named has another
// value on a rank than on the leader. `when` is a part of the message.
void CheckAlike(Collective& ranks, const std::map<std::string, std::string>& mine,
                const std::string& when);

}  // namespace sandwright
