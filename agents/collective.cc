#include "agents/collective.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "data/base/error.h"

namespace sandwright {
namespace {

class LoneCollective final : public Collective {
 public:
  LoneCollective() : Collective(0, 1) {}
  void Sum(std::span<float>) override {}
  std::vector<std::byte> Gather(std::span<const std::byte> mine) override {
    return {mine.begin(), mine.end()};
  }
  void CheckIn() override {}
  void Leave() override {}
};

// Of what all ranks know alike, one speaks.
[[noreturn]] void ThrowTogether(Collective& ranks, const std::string& message, ErrorKind kind) {
  if (!ranks.leads()) spdlog::set_level(spdlog::level::off);
  ranks.Leave();
  throw Error(message, kind);
}

}  // namespace

Collective& Alone() {
  static LoneCollective alone;  // has no state
  return alone;
}

std::vector<std::string> GatherTexts(Collective& ranks, const std::string& mine) {
  const std::vector<size_t> lengths = GatherAll<size_t>(ranks, std::vector{mine.size()});
  std::string padded = mine;
  padded.resize(std::ranges::max(lengths));
  const std::vector<char> all = GatherAll<char>(ranks, padded);
  std::vector<std::string> texts;
  for (size_t i = 0; i < lengths.size(); ++i)
    texts.emplace_back(all.data() + i * padded.size(), lengths[i]);
  return texts;
}

std::vector<float> GatherSteps(Collective& ranks, std::span<const float> mine, size_t envs,
                               size_t width) {
  const std::vector<float> all = GatherAll<float>(ranks, mine);
  const size_t size = static_cast<size_t>(ranks.size()), row = envs * width;
  std::vector<float> ordered(all.size());
  for (size_t rank = 0; rank < size; ++rank)
    for (size_t step = 0; step * row < mine.size(); ++step)
      std::copy_n(all.begin() + static_cast<std::ptrdiff_t>(rank * mine.size() + step * row), row,
                  ordered.begin() + static_cast<std::ptrdiff_t>((step * size + rank) * row));
  return ordered;
}

void AllOrNone(Collective& ranks, const std::function<void()>& work) {
  std::optional<Error> fault;
  try {
    work();
  } catch (const Error& e) {
    fault = e;
  }
  if (ranks.size() == 1) {
    if (fault) throw *fault;
    return;
  }
  // Empty: no fault. Else a byte for its kind, then the message.
  std::string mine;
  if (fault) mine = static_cast<char>(fault->kind()) + std::string(fault->what());
  const std::vector<std::string> all = GatherTexts(ranks, mine);
  const auto first = std::ranges::find_if(all, [](const std::string& s) { return !s.empty(); });
  if (first == all.end()) return;
  ThrowTogether(ranks,
                first == all.begin()
                    ? first->substr(1)
                    : fmt::format("rank {}: {}", first - all.begin(), first->substr(1)),
                static_cast<ErrorKind>(first->front()));
}

void CheckAlike(Collective& ranks, const std::map<std::string, std::string>& mine,
                const std::string& when) {
  const std::vector<std::string> all = GatherTexts(ranks, nlohmann::json(mine).dump());
  for (size_t rank = 1; rank < all.size(); ++rank) {
    if (all[rank] == all[0]) continue;
    const auto leader = nlohmann::json::parse(all[0]), other = nlohmann::json::parse(all[rank]);
    for (const auto& [name, value] : leader.items())
      if (!other.contains(name) || other[name] != value)
        ThrowTogether(ranks,
                      fmt::format("rank {} differs from rank 0 {}: {} is {} there, {} here", rank,
                                  when, name, other.value(name, "missing"),
                                  value.get<std::string>()),
                      ErrorKind::kBadInput);
    ThrowTogether(ranks, fmt::format("rank {} has more than rank 0 {}", rank, when),
                  ErrorKind::kBadInput);
  }
}

}  // namespace sandwright
