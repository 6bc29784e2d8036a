/* The start-up of a Cortex-M4F before main: its vectors, its floating-point unit, its variables. */
#include <stdint.h>
#include <stdlib.h>

extern uint32_t data_start[], data_end[], data_load[], bss_start[], bss_end[], stack_top[];
extern int main(void);

/* The application's timer, if it has one. */
void systick(void);

void reset(void);

static void fault(void)
{
    exit(EXIT_FAILURE);
}

__attribute__((weak)) void systick(void)
{
    fault();
}

/* Coprocessor access: the floating-point unit is off after a reset. */
#define CPACR (*(volatile uint32_t *)0xE000ED88u)

void reset(void)
{
    CPACR |= 0xFu << 20;
    __asm volatile("dsb\n isb" ::: "memory");
    const uint32_t *from = data_load;
    for (uint32_t *to = data_start; to < data_end; to++)
        *to = *from++;
    for (uint32_t *to = bss_start; to < bss_end; to++)
        *to = 0;
    exit(main());
}

typedef void (*vector)(void);

/* The stack, and the core's exceptions. No interrupt of the board is used. */
__attribute__((section(".vectors"), used)) static const struct {
    uint32_t *stack;
    vector exceptions[15];
} vectors = {
    stack_top,
    {reset, fault, fault, fault, fault, fault, 0, 0, 0, 0, fault, fault, 0, fault, systick},
};
