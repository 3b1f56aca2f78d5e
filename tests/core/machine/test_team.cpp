#include "machine/team.hpp"

#include <atomic>
#include <cfenv>
#include <chrono>
#include <set>
#include <thread>
#include <vector>

#ifndef _WIN32
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>
#endif

#include "check.hpp"

using namespace softffd;

namespace {

/// Two pieces that happen at the same time: each is done once both have begun.
template <class Piece>
void share_at_once(Team& team, Piece&& piece) {
  std::atomic<int> begun{0};
  team.share([&](int n) {
    piece(n);
    ++begun;
    while (begun < 2) std::this_thread::yield();
  });
  CHECK(begun == 2);
}

}  // namespace

TEST(each_piece_is_done_once_in_every_round) {
  for (const int members : {1, 2, 3, 7}) {
    Team team(members);
    std::vector<int> done(members);
    int all = 0;
    for (int round = 1; round <= 2000; ++round) {
      team.share([&](int piece) { ++done[piece]; });
      for (const int times : done) all += times;
      for (const int times : done) CHECK(times == round);
    }
    CHECK(all == members * 2000 * 2001 / 2);
  }
}

TEST(pieces_happen_at_the_same_time_and_helpers_that_sleep_wake_up) {
  Team team(2);
  for (int round = 0; round < 3; ++round) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    std::thread::id by[2];
    share_at_once(team, [&](int piece) { by[piece] = std::this_thread::get_id(); });
    CHECK(by[0] != by[1]);
  }
}

TEST(helpers_round_as_results_assume_whatever_their_maker_does) {
  std::fesetround(FE_UPWARD);
  Team team(2);
  std::fesetround(FE_TONEAREST);
  int rounding[2];
  share_at_once(team, [&](int piece) { rounding[piece] = std::fegetround(); });
  CHECK(rounding[0] == FE_TONEAREST && rounding[1] == FE_TONEAREST);
}

#ifndef _WIN32
TEST(no_signal_is_delivered_to_helpers) {
  Team team(2);
  int blocked[2];
  share_at_once(team, [&](int piece) {
    sigset_t mask;
    pthread_sigmask(SIG_SETMASK, nullptr, &mask);
    blocked[piece] = sigismember(&mask, SIGINT);
  });
  CHECK(blocked[0] + blocked[1] == 1);
}

TEST(the_child_of_a_fork_does_all_pieces_and_ends) {
  Team team(3);
  team.share([](int) {});
  const pid_t child = fork();
  if (child == 0) {
    alarm(20);
    int done[3] = {};
    for (int round = 0; round < 10; ++round) team.share([&](int piece) { ++done[piece]; });
    team.~Team();
    _exit(done[0] == 10 && done[1] == 10 && done[2] == 10 ? 0 : 1);
  }
  int status = -1;
  CHECK(waitpid(child, &status, 0) == child);
  CHECK(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}
#endif
