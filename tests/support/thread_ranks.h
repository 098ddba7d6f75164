// Ranks of a run as threads of one process.
#pragma once

#include <barrier>
#include <exception>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

#include "agents/collective.h"

namespace sandwright {

class ThreadRanks {
 public:
  explicit ThreadRanks(int size) : barrier_(size), posted_(static_cast<size_t>(size)) {}

  // Runs `body` once a rank, and returns what each threw (null: nothing). One that ends early is missed
  // by the others for ever: all must end alike.
  std::vector<std::exception_ptr> Run(const std::function<void(Collective&)>& body) {
    std::vector<std::exception_ptr> thrown(posted_.size());
    std::vector<std::thread> threads;
    for (size_t rank = 0; rank < posted_.size(); ++rank)
      threads.emplace_back([&, rank] {
        Member member(*this, static_cast<int>(rank));
        try {
          body(member);
        } catch (...) {
          thrown[rank] = std::current_exception();
        }
      });
    for (std::thread& thread : threads) thread.join();
    return thrown;
  }

 private:
  class Member final : public Collective {
   public:
    Member(ThreadRanks& ranks, int rank)
        : Collective(rank, static_cast<int>(ranks.posted_.size())), ranks_(ranks) {}

    void Sum(std::span<float> numbers) override {
      const std::vector<float> all = GatherAll<float>(*this, numbers);
      for (size_t i = 0; i < numbers.size(); ++i) {
        double sum = 0;
        for (size_t at = i; at < all.size(); at += numbers.size()) sum += all[at];
        numbers[i] = static_cast<float>(sum);
      }
    }

    std::vector<std::byte> Gather(std::span<const std::byte> mine) override {
      ranks_.posted_[static_cast<size_t>(rank())] = mine;
      ranks_.barrier_.arrive_and_wait();
      std::vector<std::byte> all;
      for (const auto& posted : ranks_.posted_) all.insert(all.end(), posted.begin(), posted.end());
      ranks_.barrier_.arrive_and_wait();  // before anyone posts anew
      return all;
    }

    void CheckIn() override {}
    void Leave() override {}

   private:
    ThreadRanks& ranks_;
  };

  std::barrier<> barrier_;
  std::vector<std::span<const std::byte>> posted_;
};

}  // namespace sandwright
