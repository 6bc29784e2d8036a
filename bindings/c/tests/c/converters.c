/* Codes of converters and their values. */
#include "check.h"

void check_converters(void)
{
    md_scale scale, never = {{0}};
    md_problem problem;
    CHECK(md_scale_init(&scale, 0.0, 0.0, &problem) == MD_ERROR_OUT_OF_RANGE);
    CHECK(md_scale_init(&scale, 0.5, 0.25, &problem) == MD_ERROR_NONE);
    /* value = full_scale*(code - 32768)/32768 - zero */
    for (uint32_t code = 0; code <= 0xFFFF; code += 0x1111) {
        const md_sample sample = md_scale_decode(&scale, 16, (uint16_t)code);
        CHECK(sample.value == 0.5f * ((float)code - 32768.0f) / 32768.0f - 0.25f && sample.code == code);
        CHECK(md_scale_encode(&scale, sample.value) == code);
    }
    /* Twelve bits over the same range: both ends are detected as ends, and the middle is 0 V. */
    CHECK(md_scale_decode(&scale, 12, 0x800).value == -0.25f && md_scale_decode(&scale, 12, 0x800).code == 0x8000);
    CHECK(md_scale_decode(&scale, 12, 0).code == 0 && md_scale_decode(&scale, 12, 0xFFF).code == 0xFFFF);
    CHECK(md_scale_decode(&scale, 12, 0xFFE).code == 0xFFE0 && md_scale_decode(&scale, 12, 0x1FFE).code == 0xFFFF);
    /* An invalid number of bits counts as 16. */
    CHECK(md_scale_decode(&scale, 0, 0x9001).code == 0x9001 && md_scale_decode(&scale, UINT32_MAX, 0x9001).code == 0x9001);
    CHECK(md_scale_encode(&scale, 9.0f) == 0xFFFF && md_scale_encode(&scale, -9.0f) == 0);
    /* Without a scale there is no measurement, and the DAC stays at 0 V. */
    const md_sample none = md_scale_decode(&never, 16, 0x9000);
    CHECK(none.value != none.value && md_scale_encode(&never, 1.0f) == 0x8000 && md_scale_encode(NULL, 1.0f) == 0x8000);
    printf("converters hold\n");
}
