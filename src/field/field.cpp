#include "field/field.hpp"

#include "grid/threads.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <new>
#include <vector>

#include <sys/mman.h>
#include <unistd.h>

namespace eulastic {
namespace {

// Calls work(begin, n) for pieces of all values, in parallel: pages are placed near the thread that writes them first.
template <class Work>
void in_parallel_pieces(std::ptrdiff_t size, int fields, const Work &work) {
  constexpr std::ptrdiff_t small = 1 << 15;
  const int parts = size < small ? 1 : threads();
  in_parallel(parts, parts, [&](int part) {
    const Piece piece(static_cast<std::size_t>(size), part, parts);
    for (int f = 0; f < fields; ++f) work(f * size + piece.begin, piece.end - piece.begin);
  });
}

// Returns a file in memory filled with one value, or -1 where the system has no such files. It is large, because every
// mapping of it counts towards a limit of the system.
constexpr std::ptrdiff_t values_in_file = std::ptrdiff_t{1} << 19;
int create_file_of(double value) {
  const int file = memfd_create("rest", MFD_CLOEXEC);
  const std::vector<double> values(values_in_file, value);
  const auto bytes = static_cast<ssize_t>(values.size() * sizeof(double));
  return file >= 0 && write(file, values.data(), bytes) == bytes ? file : -1;
}

// Maps private pages: anonymous (file = -1), or of a file.
void *map_pages(void *at, std::size_t bytes, int flags, int file) {
  void *memory = mmap(at, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | flags, file, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  return memory;
}

constexpr std::ptrdiff_t values_in_pages = std::ptrdiff_t{1} << 13;  // 64 KiB, the largest page size of all systems

// Replaces the pages that lie completely in [from, to) by pages of the file. Returns the end of the last one.
double *map_file(int file, double *from, double *to) {
  for (std::ptrdiff_t n; file >= 0 && (n = std::min(to - from, values_in_file) / values_in_pages * values_in_pages) > 0;
       from += n)
    map_pages(from, n * sizeof(double), MAP_FIXED | MAP_NORESERVE, file);
  return from;
}

}  // namespace

// Stencils access many pages at once; with huge pages, where the system has them, the addresses fit the TLB. Large
// fields are not allocated on the heap, because MPI may keep the heap from returning freed memory to the system.
Field::Memory Field::allocate(std::size_t values) {
  constexpr std::size_t line = 64, huge = std::size_t{1} << 21;
  const std::size_t bytes = values * sizeof(double);
  if (bytes < huge) {
    void *memory = std::aligned_alloc(line, (bytes + line - 1) / line * line);
    if (!memory) throw std::bad_alloc();
    return Memory(static_cast<double *>(memory), Deleter{false, 0});
  }
  // the last huge page is used if at least half of it is
  const std::size_t whole = bytes % huge < huge / 2 ? bytes : (bytes + huge - 1) / huge * huge;
  auto *memory = static_cast<std::byte *>(map_pages(nullptr, whole + huge, MAP_ANONYMOUS, -1));
  const std::size_t before = -reinterpret_cast<std::uintptr_t>(memory) % huge;
  if (before > 0) (void)munmap(memory, before);
  memory += before;
#ifdef MADV_HUGEPAGE
  (void)madvise(memory, whole, MADV_HUGEPAGE);  // a hint, which the system may refuse
#endif
  return Memory(reinterpret_cast<double *>(memory), Deleter{false, whole + huge - before});
}

// Pages are copied by the system when they are first written. Zeros are mapped from a file like ones, because not every
// system shares a page of zeros among all pages that are only read.
Field::Memory Field::allocate_on_demand(std::size_t values, std::size_t ones) {
  static const int file_of_zeros = create_file_of(0), file_of_ones = create_file_of(1);
  const std::size_t bytes = values * sizeof(double);
  Memory memory(static_cast<double *>(map_pages(nullptr, bytes, MAP_ANONYMOUS | MAP_NORESERVE, -1)),
                Deleter{false, bytes});
#ifdef MADV_NOHUGEPAGE
  (void)madvise(memory.get(), bytes, MADV_NOHUGEPAGE);  // a huge page would hold many rows
#endif
  double *begin = memory.get(), *zeros = begin + (ones + values_in_pages - 1) / values_in_pages * values_in_pages;
  std::fill(map_file(file_of_ones, begin, begin + ones), begin + ones, 1.0);
  if (zeros < begin + values) map_file(file_of_zeros, zeros, begin + values);
  return memory;
}

void Field::Deleter::operator()(double *p) const noexcept {
  if (borrowed) return;
  if (mapped > 0)
    (void)munmap(p, mapped);
  else
    std::free(p);
}

Field::Field(const Box &box, int count) : layout_(box.layout()), count_(count) {
  data_ = allocate(size());
  clear();
}

Field Field::on_demand(const Box &box, int count, int ones) {
  Field field;
  field.layout_ = box.layout();
  field.count_ = count;
  field.on_demand_ = true;
  field.ones_ = ones;
  field.data_ = allocate_on_demand(field.size(), ones * field.layout_.size);
  return field;
}

Field Field::in_memory(const Box &box, int count, double *memory) noexcept {
  Field field;
  field.layout_ = box.layout();
  field.count_ = count;
  field.data_ = {memory, Deleter{true, 0}};
  return field;
}

Field Field::part(int first, int count) noexcept {
  Field field;
  field.layout_ = layout_;
  field.count_ = count;
  field.on_demand_ = on_demand_;
  field.ones_ = std::clamp(ones_ - first, 0, count);
  field.data_ = {data_.get() + first * layout_.size, Deleter{true, 0}};
  return field;
}

void Field::fill(int f, double value) noexcept { std::fill_n(data_.get() + f * layout_.size, layout_.size, value); }

void Field::clear() noexcept {
  in_parallel_pieces(layout_.size, count_,
                     [this](std::size_t begin, std::size_t n) { std::fill_n(data_.get() + begin, n, 0.0); });
}

void Field::copy_from(const Field &other) {
  const bool is_new = count_ != other.count_ || layout_.size != other.layout_.size;
  if (is_new) {
    on_demand_ = other.on_demand_;
    ones_ = other.ones_;
    data_ = on_demand_ ? allocate_on_demand(other.size(), ones_ * other.layout_.size) : allocate(other.size());
  }
  layout_ = other.layout_;
  count_ = other.count_;
  copy(other.data_.get(), is_new);
}

void Field::allocate_fully() {
  if (!std::exchange(on_demand_, false)) return;
  const Memory before = std::exchange(data_, allocate(size()));
  copy(before.get(), true);
}

// Pages with equal values are not written, so that they stay unallocated. A new field holds its defaults, which are not
// read.
void Field::copy(const double *values, bool is_new) {
  constexpr std::size_t page = 512;
  static const std::vector<double> zeros(page, 0.0), ones(page, 1.0);
  in_parallel_pieces(layout_.size, count_, [&](std::size_t begin, std::size_t n) {
    const double *defaults = begin < ones_ * static_cast<std::size_t>(layout_.size) ? ones.data() : zeros.data();
    for (std::size_t at = begin; at < begin + n; at += page) {
      const std::size_t bytes = std::min(page, begin + n - at) * sizeof(double);
      const bool known = !is_new || on_demand_;
      if (known && std::memcmp(is_new ? defaults : data_.get() + at, values + at, bytes) == 0) continue;
      std::memcpy(data_.get() + at, values + at, bytes);
    }
  });
}

}  // namespace eulastic
