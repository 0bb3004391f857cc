// Boots the network of an XML file and reads the vendor-ID of node 5, in C++17.
#include <mcanopen.h>
#include <paraInfo.h>
#include <scanopen.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <iostream>
#include <optional>
#include <string_view>

namespace {

constexpr std::uint32_t vendor_of_pump = 0x1A0000EE;

struct Manager {
    Manager() { mcanOpenInitialize(); }
    ~Manager() { mcanOpenCleanup(); }
    Manager(const Manager &) = delete;
    Manager &operator=(const Manager &) = delete;
};

bool boot(const char *file)
{
    constexpr auto up = static_cast<long>(NOD_NOT_VAL | PARA_UC | MCANOPEN_MSG_NETWORK_UP);
    EVENT_T event{};

    if (mcanOpenConfig(file) != MCANOPEN_OK) {
        std::cerr << mcanOpenGetErrorText() << '\n';
        return false;
    }
    mcanOpenStart();
    while (event.event != up && mcanOpenEvent(&event, 1) == MCANOPEN_OK)
        continue;
    return event.event == up;
}

std::optional<std::uint32_t> read_vendor(unsigned short node)
{
    std::array<unsigned char, 4> bytes{};
    int length = bytes.size();

    if (mcanOpenReadSDO(0, node, 0x1018, 1, bytes.data(), &length, nullptr) != MCANOPEN_OK ||
        length != 4)
        return std::nullopt;
    std::uint32_t vendor = 0;
    for (std::size_t i = bytes.size(); i > 0; i--)
        vendor = vendor << 8 | bytes[i - 1];
    return vendor;
}

} // namespace

int main(int argc, char **argv)
{
    const Manager manager;

    if (argc < 2 || !boot(argv[1]))
        return 1;
    const auto vendor = read_vendor(5);
    const std::string_view text = ucParaInfo[MCANOPEN_MSG_NETWORK_UP];
    std::cout << text << ", vendor-ID " << std::hex << vendor.value_or(0) << '\n';
    return vendor == vendor_of_pump && !text.empty() ? 0 : 2;
}
