#include "scheduler/state/journal.hpp"
#include "tests/fuzz/fuzzer.hpp"
#include "tests/support/scanned_journal.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate::fuzz {
namespace {

/// The records and the result of a scan; the next scan must find the same.
std::vector<std::string> headersOf(const test::ScannedJournal& scan) {
  std::vector<std::string> headers;
  for (const auto& found : scan.records) headers.push_back(found.header);
  return headers;
}

/// Repairs the journal as the job store and `check --repair` do.
void mend(const std::filesystem::path& directory, const JournalScan& scan) {
  Journal journal(directory, scan.end, 1 << 20);
  for (const JournalPosition& torn : scan.torn) journal.drop(torn);
  journal.fillMissing();
  for (const JournalGap& gap : scan.gaps)
    if (gap.kind == JournalGap::Kind::damaged) journal.drop(gap.where);
}

/// Up to three segments, each with a length and its bytes.
void readSegments(std::string_view bytes) {
  static const test::TemporaryDirectory directory;
  for (const auto& entry : std::filesystem::directory_iterator(directory.path()))
    std::filesystem::remove(entry.path());
  const JournalReader reader(directory.path());
  Choices choices(bytes);
  for (std::uint32_t segment = 1; segment <= 3 && !choices.done(); ++segment) {
    const std::string_view content = choices.takeBytes();
    if (segment != 2 || !content.empty()) putInto(reader.segmentPath(segment), content);
  }
  const test::ScannedJournal scan = test::scanned(reader);
  for (const auto& found : scan.records) try {
      require(reader.read(found.where).header == found.header, "another record lies there");
    } catch (const DamagedRecord&) {
      // Scans of full segments do not read this payload.
    }
  for (const JournalGap& gap : scan.gaps) try {
      reader.readHeader(gap.where);
    } catch (const DamagedRecord&) {
      // The gap contains no record, or only a part of one.
    }
  mend(directory.path(), scan);
  const test::ScannedJournal mended = test::scanned(reader);
  require(headersOf(mended) == headersOf(scan), "mending a journal changes what is whole in it");
}

std::vector<std::string> journalSeeds() {
  const test::TemporaryDirectory directory;
  Journal journal(directory.path(), {}, 200);
  for (int n = 0; n < 6; ++n)
    journal.append(fmt::format("header {}", n), std::string(static_cast<std::size_t>(20 * n), 'x'));
  journal.drop({1, 0, 28});
  Script whole, one_missing;
  for (const std::uint32_t segment : journal.segments()) {
    const std::string content = bytesIn(journal.segmentPath(segment));
    whole.putBytes(content);
    one_missing.putBytes(segment == 2 ? "" : content);
  }
  return {whole.text(), one_missing.text()};
}

const Registration journal_fuzzer({"journal", readSegments, journalSeeds});

}  // namespace
}  // namespace palpate::fuzz
