/// Threads that share a loop with the one that runs it, piece by piece, each piece once: team_threads.cpp. Where the target has no threads,
/// the one that asks does all: team_single.cpp. What a piece does must not depend on who does it.
#pragma once
#include <memory>

namespace softffd {

class Team {
 public:
  /// members: >= 1, with the thread that asks. Where the system gives fewer threads, those do the work.
  explicit Team(int members);
  ~Team();
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;

  int members() const { return members_; }
  /// act(0) ... act(members() - 1), which must not throw; they have happened when this returns. For one thread at a time.
  template <class Act>
  void share(const Act& act) {
    run({[](const void* of, int piece) { (*static_cast<const Act*>(of))(piece); }, &act});
  }

 private:
  struct StepContext {
    void (*act)(const void* of, int piece);
    const void* of;
  };
  void run(const StepContext& context);

  int members_;
  struct Helpers;  ///< the other threads, and what they share
  std::unique_ptr<Helpers> helpers_;
};

}  // namespace softffd
