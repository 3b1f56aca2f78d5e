#include "machine/team.hpp"

#include <cfenv>
#include <chrono>
#include <set>

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

TEST(numbers_are_shared_in_whole_cache_lines_each_once) {
  for (const int members : {1, 2, 3, 7})
    for (const std::ptrdiff_t count : {std::ptrdiff_t{0}, least_shared, 2 * least_shared, 2 * least_shared + 1, 7 * least_shared + 13}) {
      Team team(members);
      std::vector<int> done(count);
      std::atomic<int> parts{0};
      in_parts(&team, count, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
        ++parts;
        if (begin % 8 != 0) parts = -1000;
        for (std::ptrdiff_t i = begin; i < end; ++i) ++done[i];
      });
      CHECK(std::all_of(done.begin(), done.end(), [](int times) { return times == 1; }));
      CHECK(parts == std::max<std::ptrdiff_t>(1, std::min<std::ptrdiff_t>(members, count / least_shared)));
    }
}

TEST(one_part_in_which_it_holds_is_enough) {
  Team team(3);
  const std::ptrdiff_t count = 5 * least_shared;
  for (Team* who : {static_cast<Team*>(nullptr), &team})
    for (const std::ptrdiff_t place : {std::ptrdiff_t{-1}, std::ptrdiff_t{0}, count / 2, count - 1})
      CHECK(in_any_part(who, count, [&](std::ptrdiff_t begin, std::ptrdiff_t end) { return begin <= place && place < end; }) ==
            (place >= 0));
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
