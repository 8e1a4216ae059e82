#include "tests/simulation/disk.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <stdexcept>

#include "tests/simulation/disk_calls.hpp"

namespace palpate::simulation {
namespace {

constexpr std::size_t sector = 512;
Disk* mounted_disk = nullptr;

std::string readAll(const std::string& path) {
  const int file = calls::open(path.c_str(), O_RDONLY | O_CLOEXEC, 0);
  if (file < 0) return {};
  std::string bytes;
  std::array<char, 1 << 16> chunk{};
  for (ssize_t n = 0; (n = ::read(file, chunk.data(), chunk.size())) > 0;)
    bytes.append(chunk.data(), static_cast<std::size_t>(n));
  calls::close(file);
  return bytes;
}

void writeAll(const std::string& path, const std::string& bytes) {
  const int file = calls::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  if (file < 0 ||
      calls::write(file, bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw std::runtime_error(path + ": cannot be written: is there room for the simulation?");
  calls::close(file);
}

/// SQLite's shared memory.
bool isTransient(const std::string& path) { return path.ends_with("-shm"); }

}  // namespace

Disk* Disk::mounted() { return mounted_disk; }

Disk::Disk(const std::filesystem::path& root, std::uint64_t seed)
    : root_(root.string()), random_(seed) {
  track();
  mounted_disk = this;
}

Disk::~Disk() { mounted_disk = nullptr; }

/// Treats all existing files as being on disk.
void Disk::track() {
  names_.clear();
  history_.clear();
  open_.clear();
  names_[root_] = {};
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root_)) {
    auto node = std::make_shared<Node>();
    node->path = entry.path().string();
    node->folder = entry.is_directory();
    if (node->folder)
      names_[node->path];
    else
      node->durable = readAll(node->path);
    if (!isTransient(node->path)) names_[folderOf(node->path)][node->path] = node;
  }
  for (const auto& [folder, names] : names_) history_[folder] = {names};
}

bool Disk::tracks(const std::string& path) const {
  return path.starts_with(root_) && !isTransient(path);
}

std::string Disk::folderOf(const std::string& path) {
  return path.substr(0, path.find_last_of('/'));
}

Disk::NodePointer Disk::nodeOf(const std::string& path) const {
  const auto folder = names_.find(folderOf(path));
  if (folder == names_.end()) return nullptr;
  const auto found = folder->second.find(path);
  return found == folder->second.end() ? nullptr : found->second;
}

void Disk::renamed(const std::string& folder) { history_[folder].push_back(names_[folder]); }

bool Disk::change() {
  if (!dead_ && changes_left_ > 0 && --changes_left_ == 0) {
    dead_ = hurt_ = true;
    changes_left_ = -1;
  }
  if (dead_) errno = EIO;
  return !dead_;
}

bool Disk::strikes(DiskFault fault, int error) {
  if (armed_.erase(fault) == 0) return false;
  hurts(fault, error);
  return true;
}

void Disk::hurts(DiskFault fault, int error) {
  // Writers must continue after a short write.
  hurt_ = hurt_ || fault != DiskFault::short_write;
  ++felt_[fault];
  errno = error;
}

void Disk::reads() {
  if (before_read_ && --reads_left_ == 0) std::exchange(before_read_, {})();
}

int Disk::open(const char* path, int flags, mode_t mode) {
  const std::string name = path;
  if (!tracks(name)) return calls::open(path, flags, mode);
  if (name.find("/segment-") != std::string::npos) reads();
  NodePointer node = nodeOf(name);
  const bool makes = !node && (flags & O_CREAT) != 0;
  const bool empties = node && (flags & O_TRUNC) != 0;
  if ((makes || empties) && !change()) return -1;
  const int file = calls::open(path, flags, mode);
  open_.erase(file);
  if (file < 0) return file;
  if (empties) node->dirty.clear();
  if (!node && names_.contains(name)) {
    node = std::make_shared<Node>();  // the root
    node->path = name;
    node->folder = true;
  }
  if (!node) {
    node = std::make_shared<Node>();
    node->path = name;
    node->streamed = !makes;
    names_[folderOf(name)][name] = node;
    renamed(folderOf(name));
  }
  if (node) open_[file] = node;
  return file;
}

int Disk::close(int file) {
  open_.erase(file);
  return calls::close(file);
}

ssize_t Disk::write(int file, const void* bytes, std::size_t count, off_t offset) {
  const auto found = open_.find(file);
  if (found == open_.end()) return calls::write(file, bytes, count, offset);
  if (dead_) return errno = EIO, -1;
  if (strikes(DiskFault::write_error, EIO)) return -1;
  if (full_) return hurts(DiskFault::full, ENOSPC), -1;
  const bool lives = change();
  if (count > 1 && (!lives || strikes(DiskFault::short_write, 0))) count = random_.below(count) + 1;
  // Position at which write() would begin.
  const off_t begin = offset >= 0 ? offset : lseek(file, 0, SEEK_CUR);
  const ssize_t written = calls::write(file, bytes, count, offset);
  if (written > 0) {
    const auto from = static_cast<std::size_t>(begin);
    found->second->dirty.emplace_back(from, from + static_cast<std::size_t>(written));
  }
  if (!lives) return errno = EIO, -1;
  return written;
}

int Disk::truncate(int file, off_t size) {
  if (!open_.contains(file)) return calls::truncate(file, size);
  return change() ? calls::truncate(file, size) : -1;
}

int Disk::sync(int file) {
  const auto found = open_.find(file);
  if (found == open_.end()) return calls::sync(file);
  if (!change()) return -1;
  Node& node = *found->second;
  if (node.folder) {
    history_[node.path] = {names_[node.path]};
    return 0;
  }
  if (strikes(DiskFault::sync_error, EIO)) {
    // The pages count as written from now on.
    node.dirty.clear();
    changes_left_ = -1;
    return -1;
  }
  const std::string now = node.path.empty() ? node.orphaned : readAll(node.path);
  if (node.streamed) node.dirty = {{0, now.size()}};
  node.durable.resize(now.size());
  for (const auto& [begin, end] : node.dirty)
    if (begin < now.size())
      node.durable.replace(begin, std::min(end, now.size()) - begin, now, begin,
                           std::min(end, now.size()) - begin);
  node.dirty.clear();
  return 0;
}

int Disk::rename(const char* from, const char* to) {
  if (!tracks(from) || !tracks(to)) return calls::rename(from, to);
  if (strikes(DiskFault::rename_error, EIO) || !change()) return -1;
  const NodePointer node = nodeOf(from), replaced = nodeOf(to);
  if (replaced) replaced->orphaned = readAll(replaced->path);
  const int result = calls::rename(from, to);
  if (result != 0 || !node) return result;
  if (replaced) replaced->path.clear();
  names_[folderOf(from)].erase(from);
  names_[folderOf(to)][to] = node;
  node->path = to;
  renamed(folderOf(to));
  if (folderOf(from) != folderOf(to)) renamed(folderOf(from));
  return 0;
}

int Disk::unlink(const char* path) {
  if (!tracks(path)) return calls::unlink(path);
  const NodePointer node = nodeOf(path);
  if (node && !change()) return -1;
  if (node) node->orphaned = readAll(node->path);
  const int result = calls::unlink(path);
  if (result != 0 || !node) return result;
  node->path.clear();
  names_[folderOf(path)].erase(path);
  renamed(folderOf(path));
  return 0;
}

int Disk::makeDirectory(const char* path, mode_t mode) {
  if (!tracks(path)) return calls::makeDirectory(path, mode);
  if (!nodeOf(path) && !change()) return -1;
  const int result = calls::makeDirectory(path, mode);
  if (result != 0) return result;
  const auto node = std::make_shared<Node>();
  node->path = path;
  node->folder = true;
  names_[folderOf(path)][path] = node;
  names_[path];
  history_[path] = {Names()};
  renamed(folderOf(path));
  return 0;
}

std::string Disk::after(const Node& node) {
  const std::string now = node.path.empty() ? node.orphaned : readAll(node.path);
  std::string left = node.durable;
  if (now.size() < left.size() && random_.chance(0.5)) left.resize(now.size());
  auto dirty = node.dirty;
  if (node.streamed && now != left) dirty = {{0, now.size()}};
  for (const auto& [begin, end] : dirty)
    for (std::size_t at = begin; at < std::min(end, now.size());) {
      const std::size_t next = std::min({(at / sector + 1) * sector, end, now.size()});
      if (random_.chance(0.5)) {
        left.resize(std::max(left.size(), next));
        left.replace(at, next - at, now, at, next - at);
      }
      at = next;
    }
  return left;
}

void Disk::rebuild(const std::string& folder, std::map<std::string, std::string>& files,
                   std::vector<std::string>& folders) {
  const std::vector<Names>& moments = history_[folder];
  const Names& left = moments[random_.below(moments.size())];
  for (const auto& [path, node] : left) {
    if (node->folder) {
      folders.push_back(path);
      rebuild(path, files, folders);
    } else {
      files[path] = after(*node);
    }
  }
}

void Disk::cutPower() {
  std::map<std::string, std::string> files;
  std::vector<std::string> folders;
  rebuild(root_, files, folders);
  mounted_disk = nullptr;  // later changes are nobody's
  for (const auto& entry : std::filesystem::directory_iterator(root_))
    std::filesystem::remove_all(entry.path());
  for (const std::string& path : folders) std::filesystem::create_directory(path);
  for (const auto& [path, bytes] : files) writeAll(path, bytes);
  mounted_disk = this;
  track();
}

void Disk::flip(const std::filesystem::path& file, std::uint64_t byte, int bit) {
  const NodePointer node = nodeOf(file.string());
  std::string bytes = readAll(file.string());
  if (!node || byte >= bytes.size()) return;
  const auto flipped = static_cast<char>(bytes[byte] ^ (1 << bit));
  const int handle = calls::open(file.c_str(), O_WRONLY | O_CLOEXEC, 0);
  if (handle < 0 || calls::write(handle, &flipped, 1, static_cast<off_t>(byte)) != 1)
    throw std::runtime_error(file.string() + ": cannot be damaged");
  calls::close(handle);
  if (byte < node->durable.size())
    node->durable[byte] = static_cast<char>(node->durable[byte] ^ (1 << bit));
}

}  // namespace palpate::simulation
