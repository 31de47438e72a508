#include "zwidth/design/internal/checkpoint.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <fcntl.h>
#include <fstream>
#include <sstream>
#include <system_error>
#include <unistd.h>

#include "zwidth/design/internal/bytes.h"

namespace zwidth::internal {
namespace {

constexpr const char* kMagic = "zwidth search checkpoint 1\n";

// FNV-1a, 64 bits: against files that end too early or were written over, not against malice.
std::uint64_t checksum(const std::string& bytes) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const char byte : bytes) hash = (hash ^ static_cast<unsigned char>(byte)) * 0x100000001b3;
  return hash;
}

std::filesystem::path beside(const std::filesystem::path& file, const char* suffix) {
  std::filesystem::path other = file;
  other += suffix;
  return other;
}

std::string packed(const Checkpoint& checkpoint) {
  ByteWriter writer;
  writer.put<std::uint64_t>(checkpoint.identity.size());
  for (const std::string& line : checkpoint.identity) writer.put(line);
  writer.put<std::uint64_t>(checkpoint.history.size());
  for (const Generation& generation : checkpoint.history) {
    writer.put(generation.number);
    writer.put(generation.evaluations);
    writer.put(generation.feasible_share);
    writer.put(generation.front);
    writer.put(generation.hypervolume);
    writer.put(generation.seconds_evaluating);
    writer.put(generation.seconds_in_algorithm);
  }
  writer.put(checkpoint.reference);
  const EvaluationRecord& record = checkpoint.record;
  writer.put(record.evaluations);
  writer.put(record.failures);
  writer.put(record.first_failure);
  writer.put(record.seconds);
  writer.put<std::uint64_t>(record.constraints.size());
  for (const ConstraintRecord& constraint : record.constraints) {
    writer.put(constraint.held);
    writer.put(constraint.undefined);
    writer.put(constraint.least_violation);
  }
  writer.put(checkpoint.rows.designs);
  writer.put(checkpoint.rows.outcomes);
  writer.put(checkpoint.memory);
  return writer.bytes();
}

Checkpoint unpacked(const std::string& bytes) {
  ByteReader reader(bytes);
  Checkpoint checkpoint;
  for (auto left = reader.get<std::uint64_t>(); left > 0; --left) checkpoint.identity.push_back(reader.text());
  for (auto left = reader.get<std::uint64_t>(); left > 0; --left) {
    Generation generation;
    generation.number = reader.get<std::int64_t>();
    generation.evaluations = reader.get<std::int64_t>();
    generation.feasible_share = reader.get<double>();
    generation.front = reader.get<std::int64_t>();
    generation.hypervolume = reader.get<double>();
    generation.seconds_evaluating = reader.get<double>();
    generation.seconds_in_algorithm = reader.get<double>();
    checkpoint.history.push_back(generation);
  }
  checkpoint.reference = reader.doubles();
  EvaluationRecord& record = checkpoint.record;
  record.evaluations = reader.get<std::int64_t>();
  record.failures = reader.get<std::int64_t>();
  record.first_failure = reader.text();
  record.seconds = reader.get<double>();
  for (auto left = reader.get<std::uint64_t>(); left > 0; --left) {
    ConstraintRecord constraint;
    constraint.held = reader.get<std::int64_t>();
    constraint.undefined = reader.get<std::int64_t>();
    constraint.least_violation = reader.get<double>();
    record.constraints.push_back(constraint);
  }
  checkpoint.rows.designs = reader.doubles();
  checkpoint.rows.outcomes = reader.doubles();
  checkpoint.memory = reader.text();
  if (!reader.at_end()) throw std::runtime_error("it is longer than it should be");
  return checkpoint;
}

// To the disk itself: after a power cut the new file must not be empty where the old one was whole.
void write_through(const std::string& bytes, const std::filesystem::path& file) {
  const auto check = [&](bool good) {
    if (good) return;
    throw std::runtime_error("cannot write the checkpoint " + file.string() + ": " +
                             std::system_category().message(errno));
  };
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  check(descriptor >= 0);
  std::size_t written = 0;
  bool good = true;
  while (good && written < bytes.size()) {
    const ssize_t count = ::write(descriptor, bytes.data() + written, bytes.size() - written);
    good = count >= 0 || errno == EINTR;
    if (count > 0) written += static_cast<std::size_t>(count);
  }
  good = good && ::fsync(descriptor) == 0;
  const int problem = errno;
  ::close(descriptor);
  errno = problem;
  check(good);
}

Checkpoint read_one(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw std::runtime_error("there is no such file");
  std::ostringstream contents;
  contents << stream.rdbuf();
  const std::string bytes = contents.str(), magic = kMagic;
  if (!bytes.starts_with(magic))
    throw std::runtime_error("it is no checkpoint of a search, or of another version");
  const std::string body = bytes.substr(magic.size());
  ByteReader reader(body);
  const auto sum = reader.get<std::uint64_t>();
  const std::string payload = reader.text();
  if (checksum(payload) != sum) throw std::runtime_error("its checksum is wrong");
  return unpacked(payload);
}

bool is_whole(const std::filesystem::path& file) {
  try {
    read_one(file);
    return true;
  } catch (const std::runtime_error&) {
    return false;
  }
}

void check_identity(const Checkpoint& checkpoint, const std::vector<std::string>& identity,
                    const std::filesystem::path& file) {
  const auto line = [](const std::vector<std::string>& lines, std::size_t i) {
    return i < lines.size() ? "\"" + lines[i] + "\"" : std::string("nothing more");
  };
  for (std::size_t i = 0; i < std::max(identity.size(), checkpoint.identity.size()); ++i) {
    if (i < identity.size() && i < checkpoint.identity.size() && identity[i] == checkpoint.identity[i])
      continue;
    throw std::runtime_error("the checkpoint " + file.string() + " is of another search: it has " +
                             line(checkpoint.identity, i) + " where this one has " + line(identity, i) +
                             "; start afresh, or go back to what it was made with");
  }
}

}  // namespace

void write_checkpoint(const Checkpoint& checkpoint, const std::filesystem::path& file) {
  const std::string payload = packed(checkpoint);
  ByteWriter body;
  body.put(checksum(payload));
  body.put(payload);
  const std::filesystem::path fresh = beside(file, ".new");
  write_through(kMagic + body.bytes(), fresh);
  // The old contents get a second name before the new ones take its place, so that FILE is never missing. What
  // is broken does not push out the one before.
  const std::filesystem::path previous = beside(file, ".previous");
  std::error_code error;
  if (is_whole(file)) {
    std::filesystem::remove(previous, error);
    std::filesystem::create_hard_link(file, previous, error);
    if (error) std::filesystem::rename(file, previous, error);  // no such links here
  }
  std::filesystem::rename(fresh, file, error);
  if (error) {
    throw std::runtime_error("cannot write the checkpoint " + file.string() + ": " + error.message());
  }
}

Checkpoint read_checkpoint(const std::filesystem::path& file, const std::vector<std::string>& identity,
                           std::vector<std::string>& notes) {
  const std::filesystem::path previous = beside(file, ".previous");
  std::optional<Checkpoint> checkpoint;
  std::filesystem::path used = file;
  try {
    checkpoint = read_one(file);
  } catch (const std::exception& newest) {
    try {
      checkpoint = read_one(previous);
    } catch (const std::exception& older) {
      throw std::runtime_error("cannot resume from " + file.string() + ": " + newest.what() + "; nor from " +
                               previous.string() + ": " + older.what());
    }
    used = previous;
    notes.push_back("the checkpoint " + file.string() + " cannot be used (" + newest.what() +
                    "); going on from the one before, generation " +
                    std::to_string(checkpoint->history.empty() ? 0 : checkpoint->history.back().number));
  }
  check_identity(*checkpoint, identity, used);
  return std::move(*checkpoint);
}

}  // namespace zwidth::internal
