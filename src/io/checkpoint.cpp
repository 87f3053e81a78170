#include "io/checkpoint.hpp"

#include "base/events.hpp"
#include "base/one_line.hpp"
#include "io/checksum.hpp"

#include <algorithm>
#include <filesystem>
#include <regex>

namespace eulastic {
namespace {

namespace fs = std::filesystem;
constexpr const char *kind = "eulastic checkpoint";
constexpr long format = 5;  // raised whenever a file means something else

// The attribute `content` of a file: which datasets it has, and which checksums.
PetscErrorCode find_content(Hdf5File &file, std::string *content) {
  std::uint64_t sum = 0;
  PetscFunctionBeginUser;
  for (const std::string &name : file.datasets()) {
    std::string checksum_of_values;
    PetscCall(file.read_attribute(name, "checksum", &checksum_of_values));
    const std::string entry = name + " " + checksum_of_values;
    sum += mix_bits(checksum(entry.data(), entry.size(), 0));
  }
  *content = checksum_text(sum);
  PetscFunctionReturn(0);
}

}  // namespace

std::string checkpoint_name(long step) { return print("checkpoint_%08ld.h5", step); }

long checkpoint_step(const std::string &path) {
  static const std::regex pattern("checkpoint_([0-9]{1,18})\\.h5");
  const std::string name = fs::path(path).filename();
  std::smatch match;
  return std::regex_match(name, match, pattern) ? std::stol(match[1]) : -1;
}

std::vector<std::string> list_checkpoints(const std::string &directory) {
  std::vector<std::string> paths;
  std::error_code error;
  for (fs::directory_iterator it(directory, error), end; !error && it != end; it.increment(error))
    if (checkpoint_step(it->path()) >= 0) paths.push_back(it->path());
  std::sort(paths.begin(), paths.end(),
            [](const std::string &a, const std::string &b) { return checkpoint_step(a) > checkpoint_step(b); });
  return paths;
}

PetscErrorCode write_checkpoint(const Domain &domain, const std::string &path, const std::string &options,
                                const CheckpointNumbers &numbers, const std::vector<CheckpointField> &fields,
                                const std::vector<CheckpointRecords> &records) {
  PetscFunctionBeginUser;
  EventScope scope(Event::write);
  Hdf5File file;
  PetscCall(file.create(domain.comm(), path));
  PetscCall(file.write_attribute("/", "kind", std::string(kind)));
  PetscCall(file.write_attribute("/", "format", format));
  PetscCall(file.write_attribute("/", "version", std::string(EULASTIC_VERSION)));
  const std::vector<unsigned char> text(options.begin(), options.end());
  PetscCall(file.write_array("options", text));
  for (const auto &[name, values] : numbers.reals) PetscCall(file.write_array(name, values));
  for (const auto &[name, values] : numbers.integers) PetscCall(file.write_array(name, values));
  for (const CheckpointField &field : fields)
    PetscCall(file.write_field(domain, {field.name, field.staggering, field.stored, true}, {field.view}));
  for (const CheckpointRecords &some : records) PetscCall(file.write_records(some.name, some.numbers, some.values));
  std::string content;
  PetscCall(find_content(file, &content));
  PetscCall(file.write_attribute("/", "content", content));
  PetscCall(file.commit());
  PetscFunctionReturn(0);
}

PetscErrorCode CheckpointFile::open(MPI_Comm comm, const std::string &path) {
  std::string found;
  double number = 0;
  PetscFunctionBeginUser;
  PetscCall(Hdf5File::open(comm, path));
  if (has_attribute("/", "kind")) PetscCall(read_attribute("/", "kind", &found));
  PetscCall(
      check(found == kind, "is not a checkpoint of this program; accepted: a file checkpoint_NNNNNNNN.h5 of a run"));
  PetscCall(read_attribute("/", "format", &number));
  PetscCall(read_attribute("/", "version", &version_));
  PetscCall(check(number == format, "has format " + std::to_string(long(number)) + " (written by version " + version_ +
                                        "), this program reads format " + std::to_string(format)));
  std::string content, expected;
  PetscCall(read_attribute("/", "content", &expected));
  PetscCall(find_content(*this, &content));
  PetscCall(check(content == expected, "is damaged: datasets or their checksums are missing or have changed"));
  PetscFunctionReturn(0);
}

PetscErrorCode CheckpointFile::read_options(std::string *options) {
  std::vector<unsigned char> text;
  PetscFunctionBeginUser;
  PetscCall(read_array("options", &text));
  options->assign(text.begin(), text.end());
  PetscFunctionReturn(0);
}

PetscErrorCode CheckpointFile::read_numbers(CheckpointNumbers *numbers) {
  PetscFunctionBeginUser;
  for (auto &[name, values] : numbers->reals) PetscCall(read_array(name, &values));
  for (auto &[name, values] : numbers->integers) PetscCall(read_array(name, &values));
  PetscFunctionReturn(0);
}

PetscErrorCode CheckpointFile::read_records(CheckpointRecords *records) {
  PetscFunctionBeginUser;
  records->values.clear();
  if (has(records->name)) PetscCall(Hdf5File::read_records(records->name, records->numbers, &records->values));
  PetscFunctionReturn(0);
}

PetscErrorCode CheckpointFile::read_fields(const Box &box, const std::vector<CheckpointField> &fields) {
  PetscFunctionBeginUser;
  for (const CheckpointField &field : fields)
    if (!field.optional || has(field.name)) PetscCall(read_field(box, field.name, field.staggering, field.view));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
