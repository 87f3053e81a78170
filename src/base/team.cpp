#include "base/team.hpp"

namespace eulastic {
namespace {

thread_local int own_number = 0;
thread_local double *own_flops = nullptr;  // null: in no team

}  // namespace

TeamMember::TeamMember(int number, double *flops) noexcept {
  own_number = number;
  own_flops = flops;
}

TeamMember::~TeamMember() {
  own_number = 0;
  own_flops = nullptr;
}

bool TeamMember::is_here() noexcept { return own_flops != nullptr; }
int TeamMember::number() noexcept { return own_number; }
void TeamMember::add_flops(double count) noexcept { *own_flops += count; }

}  // namespace eulastic
