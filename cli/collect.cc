// sandwright collect: random strokes executed one after another, before and after kept.
#include "env/collect.h"

#include <spdlog/fmt/fmt.h>

#include "cli/command.h"
#include "data/base/error.h"

namespace sandwright {
namespace {

class CollectCommand final : public Command {
 public:
  void Declare(CLI::App& app) override {
    app.add_option("--source", request_.source,
                   "who moves the sand: heightfield or dem (grains, needs LAMMPS)")
        ->check(CLI::IsMember({"heightfield", "dem"}))
        ->capture_default_str();
    app.add_option("--strokes", request_.strokes, "strokes in all, with those that exist")
        ->required();
    app.add_option("--sequence", request_.sequence,
                   "strokes a bed (default: 10 with a folder, all with a file)");
    app.add_option("--out", out_,
                   "folder (one file a bed) or one .h5 file; what exists is continued")
        ->required();
  }
  void Fields(FieldList& f) override { config_.Fields(f); }

  int Run() override {
    request_.out = out_;
    if (request_.sequence == 0)
      request_.sequence = request_.out.extension() == ".h5" ? request_.strokes : 10;
    request_.seed = seed();
    request_.threads = threads();
    const Collected collected = Collect(config_, request_);
    fmt::print("{} strokes in {}, {} of them new\n", collected.strokes, out_, collected.added);
    ThrowIfStopRequested();
    WriteResult({{"source", request_.source},
                 {"strokes", collected.strokes},
                 {"strokes_added", collected.added},
                 {"sequence", request_.sequence},
                 {"out", out_}});
    return 0;
  }

 private:
  CollectConfig config_;
  CollectRequest request_;
  std::string out_;
};

}  // namespace

std::unique_ptr<Command> MakeCollectCommand() { return std::make_unique<CollectCommand>(); }

}  // namespace sandwright
