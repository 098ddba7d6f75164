// Every command of docs/first_day.md, in its order.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/support/program.h"

namespace sandwright {
namespace {

namespace fs = std::filesystem;

// The indented lines.
std::vector<std::string> Commands(const fs::path& document) {
  std::ifstream in(document);
  std::vector<std::string> commands;
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with("    ")) continue;
    commands.push_back(line.substr(4));
  }
  return commands;
}

TEST(FirstDay, EveryCommandWorks) {
  const fs::path folder = fs::path(::testing::TempDir()) / "first_day";
  fs::remove_all(folder);
  fs::create_directories(folder);
  const std::vector<std::string> commands = Commands(SANDWRIGHT_ROOT "/docs/first_day.md");
  ASSERT_GT(commands.size(), 10u);
  for (const std::string& command : commands) {
    const Finished done = Shell("cd " + folder.string() +
                                " && sandwright() { " SANDWRIGHT_PROGRAM " \"$@\"; }; "
                                "SANDWRIGHT_CONFIGS=" SANDWRIGHT_ROOT "/configs; " +
                                command);
    ASSERT_EQ(done.exit_code, 0) << command << "\n" << done.output;
  }
  for (const char* file : {"cell.png", "goal.png", "preview.png", "second/strokes.h5", "own.safetensors",
                           "goal.stl", "plan.dxf"})
    EXPECT_TRUE(fs::exists(folder / file)) << file;
}

}  // namespace
}  // namespace sandwright
