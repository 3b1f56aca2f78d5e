/// Threads that share the pieces of a loop with the calling thread; each piece is done once (team_threads.cpp). On a target without
/// threads the calling thread does all pieces (team_single.cpp). The result of a piece must not depend on the thread that does it.
#pragma once
#include <memory>

namespace softffd {

class Team {
 public:
  /// members: number of threads with the calling one, >= 1. If the system gives fewer threads, those do all the work.
  explicit Team(int members);
  ~Team();
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;

  int members() const { return members_; }
  /// Calls act(0) ... act(members() - 1), which must not throw, and returns when all calls have ended. For one calling thread at a time.
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
