// Which receivers the viewer sees: 1 or 0 each.
layout(std430, binding = LAMINA_SHADOW_RECEIVER_BINDING) buffer LaminaShadowReceivers {
    uint laminaReceivers[];
};
