// SPDX-License-Identifier: Apache-2.0
// PCL's readers and writer. They get new headers with neutral field names, because PCL treats some names specially and
// does not check malformed headers.
#include "pcl_module/pcl_clouds.hpp"

#include <pcl/PCLPointCloud2.h>
#include <pcl/console/print.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <sstream>

namespace cluxel::scan {

namespace {

char pcdTypeOf(FieldType type) {
  if (type == FieldType::F32 || type == FieldType::F64) return 'F';
  const bool is_signed =
      type == FieldType::I8 || type == FieldType::I16 || type == FieldType::I32 || type == FieldType::I64;
  return is_signed ? 'I' : 'U';
}

std::uint8_t pclTypeOf(FieldType type) {
  using F = pcl::PCLPointField;
  constexpr std::array types{F::INT8,   F::UINT8, F::INT16,  F::UINT16,  F::INT32,
                             F::UINT32, F::INT64, F::UINT64, F::FLOAT32, F::FLOAT64};
  return static_cast<std::uint8_t>(types[static_cast<std::size_t>(type)]);
}

std::string pcdHeader(const std::vector<PointField>& fields, std::size_t count, bool compressed) {
  std::ostringstream names, sizes, types, counts;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    names << " f" << i;
    sizes << ' ' << bytesOf(fields[i].type);
    types << ' ' << pcdTypeOf(fields[i].type);
    counts << ' ' << fields[i].count;
  }
  std::ostringstream header;
  header << "VERSION .7\nFIELDS" << names.str() << "\nSIZE" << sizes.str() << "\nTYPE" << types.str() << "\nCOUNT"
         << counts.str() << "\nWIDTH " << count << "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " << count << "\nDATA "
         << (compressed ? "binary_compressed" : "binary") << '\n';
  return header.str();
}

/// Written here because PCL writes six digits: decimetres at a position far from the origin.
std::string viewpointLine(const Eigen::Isometry3d& T_map_sensor) {
  const Eigen::Vector3d t = T_map_sensor.translation();
  const Eigen::Quaterniond q(T_map_sensor.rotation());
  std::string line = "VIEWPOINT";
  for (const double value : {t.x(), t.y(), t.z(), q.w(), q.x(), q.y(), q.z()}) {
    std::array<char, 32> digits{};
    line += ' ' + std::string(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr);
  }
  return line;
}

std::string plyHeader(const std::vector<PointField>& fields, std::size_t count, bool big_endian) {
  constexpr std::array names{"int8", "uint8", "int16", "uint16", "int32", "uint32", "", "", "float32", "float64"};
  std::ostringstream header;
  header << "ply\nformat binary_" << (big_endian ? "big" : "little") << "_endian 1.0\nelement vertex " << count << '\n';
  for (std::size_t i = 0; i < fields.size(); ++i)
    header << "property " << names[static_cast<std::size_t>(fields[i].type)] << " f" << i << '\n';
  header << "end_header\n";
  return header.str();
}

std::string recordsOf(const pcl::PCLPointCloud2& cloud, std::size_t stride, std::size_t count,
                      const std::string& file) {
  if (cloud.point_step != stride || cloud.data.size() != stride * count)
    refuseFile(file, "PCL decoded another number of points than the header declares");
  return {reinterpret_cast<const char*>(cloud.data.data()), cloud.data.size()};
}

/// A file in memory, for readers that only take a path.
class MemoryFile {
 public:
  MemoryFile(std::string_view head, std::string_view body) : descriptor_(memfd_create("cluxel", MFD_CLOEXEC)) {
    if (descriptor_ < 0 || !append(head) || !append(body)) {
      const std::string reason = std::strerror(errno);
      if (descriptor_ >= 0) close(descriptor_);
      throw Error(ErrorKind::StoreUnavailable, "a file in memory cannot be made: " + reason);
    }
  }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  ~MemoryFile() { close(descriptor_); }
  std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  bool append(std::string_view bytes) const {
    while (!bytes.empty()) {
      const ssize_t written = write(descriptor_, bytes.data(), bytes.size());
      if (written <= 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(written));
    }
    return true;
  }
  int descriptor_;
};

/// Runs one of PCL's readers; its exceptions and error codes become an InputError about the file.
template <typename Read>
void readThroughPcl(const std::string& file, const Read& read) {
  silencePcl();
  int result = -1;
  try {
    result = read();
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {
    refuseFile(file, std::string("PCL cannot decode it: ") + e.what());
  }
  if (result < 0) refuseFile(file, "PCL cannot decode it: the data are damaged");
}

}  // namespace

void silencePcl() {
  static const bool silenced = [] {  // once for the process
    pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
    return true;
  }();
  (void)silenced;
}

std::string pcdRecords(std::string_view body, const std::vector<PointField>& fields, std::size_t count, bool compressed,
                       const std::string& file) {
  pcl::PCLPointCloud2 cloud;
  readThroughPcl(file, [&] {
    pcl::PCDReader reader;
    std::istringstream header(pcdHeader(fields, count, compressed));
    Eigen::Vector4f origin;
    Eigen::Quaternionf orientation;
    int version = 0;
    int data_type = 0;
    unsigned body_offset = 0;
    if (const int failed = reader.readHeader(header, cloud, origin, orientation, version, data_type, body_offset);
        failed < 0)
      return failed;
    return reader.readBodyBinary(reinterpret_cast<const unsigned char*>(body.data()), cloud, version, compressed, 0);
  });
  return recordsOf(cloud, recordBytes(fields), count, file);
}

std::string plyRecords(std::string_view body, const std::vector<PointField>& fields, std::size_t count, bool big_endian,
                       const std::string& file) {
  pcl::PCLPointCloud2 cloud;
  const MemoryFile memory(plyHeader(fields, count, big_endian), body);
  readThroughPcl(file, [&] {
    pcl::PLYReader reader;
    return reader.read(memory.path(), cloud);
  });
  return recordsOf(cloud, recordBytes(fields), count, file);
}

std::string pcdFile(std::string_view records, const std::vector<PointField>& fields, std::size_t count,
                    const Eigen::Isometry3d& T_map_sensor) {
  silencePcl();
  pcl::PCLPointCloud2 cloud;
  for (const PointField& field : fields) {
    pcl::PCLPointField out;
    out.name = field.name;
    out.offset = cloud.point_step;
    out.datatype = pclTypeOf(field.type);
    out.count = static_cast<pcl::uindex_t>(field.count);
    cloud.fields.push_back(out);
    cloud.point_step += static_cast<pcl::uindex_t>(field.count * bytesOf(field.type));
  }
  cloud.width = static_cast<pcl::uindex_t>(count);
  cloud.height = 1;
  cloud.row_step = cloud.point_step * cloud.width;
  pcl::PCDWriter writer;
  std::string file = writer.generateHeaderBinary(cloud, Eigen::Vector4f::Zero(), Eigen::Quaternionf::Identity());
  const std::size_t line = file.find("VIEWPOINT");
  file.replace(line, file.find('\n', line) - line, viewpointLine(T_map_sensor));
  return file + "DATA binary\n" + std::string(records);
}

}  // namespace cluxel::scan
