/// Threads that share a loop with the one that runs it, piece by piece, each piece once.
///
///      the one that asks:   new round | own piece | pieces that nobody has begun | wait for the others' | on with the step
///      a helper:            ... wait  | own piece | pieces that nobody has begun | wait ...
///
/// Whoever comes first takes a piece, its own before others': a helper that the system lets wait costs nothing, and in the child of a fork,
/// which has no helpers, the one that asks does all. What a piece does must not depend on who does it. Between two rounds helpers spin for
/// half a millisecond, most of it letting others run, and then sleep. They have the floating-point environment that results assume, and no
/// signal is delivered to them.
#pragma once
#include <atomic>
#include <cstddef>
#include <memory>
#include <thread>
#include <vector>

namespace softffd {

class Team {
 public:
  /// members: >= 1, with the thread that asks. Where the system gives fewer threads, those do the work.
  explicit Team(int members);
  ~Team();
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;

  int members() const { return int(pieces_.size()); }
  /// act(0) ... act(members() - 1), which must not throw; they have happened when this returns. For one thread at a time.
  template <class Act>
  void share(const Act& act) {
    run({[](const void* of, int piece) { (*static_cast<const Act*>(of))(piece); }, &act});
  }

 private:
  static constexpr int cache_line = 64;
  struct StepContext {
    void (*act)(const void* of, int piece);
    const void* of;
  };
  struct alignas(cache_line) Piece {
    std::atomic<unsigned> round{0};  ///< in which it was begun last
  };
  void run(const StepContext& context);
  void take_pieces(int own, unsigned round);
  void help(int own);

  std::vector<Piece> pieces_;
  StepContext job_{};
  alignas(cache_line) std::atomic<unsigned> round_{0};
  alignas(cache_line) std::atomic<int> left_{0};  ///< pieces of the round that have not ended
  std::atomic<bool> over_{false};
  std::unique_ptr<std::vector<std::thread>> helpers_;
  long process_;  ///< in which the helpers are
};

}  // namespace softffd
