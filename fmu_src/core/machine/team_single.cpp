/// A team where the target has no threads: there are no helpers, and the one that asks does piece after piece.
#include "machine/team.hpp"

namespace softffd {

struct Team::Helpers {};

Team::Team(int members) : members_(members) {}

Team::~Team() = default;

void Team::run(const StepContext& context) {
  for (int piece = 0; piece < members_; ++piece) context.act(context.of, piece);
}

}  // namespace softffd
