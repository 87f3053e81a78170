#include "field/field_block.hpp"

#include "grid/threads.hpp"

#include <algorithm>
#include <new>

#include <sys/mman.h>

namespace eulastic {
namespace {

// work(begin, n) on all values, by all threads: pages come to lie near who touches them first.
template <class Work>
void in_pieces(std::ptrdiff_t size, int fields, const Work &work) {
  constexpr std::ptrdiff_t small = 1 << 15;
  const int parts = size < small ? 1 : threads();
  in_parallel(parts, parts, [&](int part) {
    const Piece piece(static_cast<std::size_t>(size), part, parts);
    for (int f = 0; f < fields; ++f) work(f * size + piece.begin, piece.end - piece.begin);
  });
}

}  // namespace

// Stencils reach over many pages at once: in huge pages, where the system has them, their addresses fit the TLB.
double *FieldBlock::allocate(std::size_t values) {
  constexpr std::size_t line = 64, huge = std::size_t{1} << 21;
  const std::size_t bytes = values * sizeof(double), alignment = bytes >= huge ? huge : line;
  void *memory = std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
  if (!memory) throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
  if (bytes >= huge) (void)madvise(memory, bytes, MADV_HUGEPAGE);  // a hint: nothing is lost when it is refused
#endif
  return static_cast<double *>(memory);
}

FieldBlock::FieldBlock(const Grid &grid, int count) : layout_(grid.layout()), count_(count) {
  data_.reset(allocate(size()));
  clear();
}

FieldBlock FieldBlock::part(int first, int count) noexcept {
  FieldBlock block;
  block.layout_ = layout_;
  block.count_ = count;
  block.data_ = {data_.get() + first * layout_.size, Free{true}};
  return block;
}

void FieldBlock::fill(int f, double value) noexcept {
  std::fill_n(data_.get() + f * layout_.size, layout_.size, value);
}

void FieldBlock::clear() noexcept {
  in_pieces(layout_.size, count_,
            [this](std::size_t begin, std::size_t n) { std::fill_n(data_.get() + begin, n, 0.0); });
}

void FieldBlock::copy_from(const FieldBlock &other) {
  if (count_ != other.count_ || layout_.size != other.layout_.size) {
    data_ = {allocate(other.size()), Free{}};
  }
  layout_ = other.layout_;
  count_ = other.count_;
  const double *from = other.data_.get();
  in_pieces(layout_.size, count_,
            [&](std::size_t begin, std::size_t n) { std::copy_n(from + begin, n, data_.get() + begin); });
}

}  // namespace eulastic
