/** Zebra stripes reflected in a surface, which show its smoothness. */
// @ts-nocheck: three.js and uPlot come without types.

const STRIPES = `
  if (zebra > 0.5) {
    vec3 mirrored = reflect(-normalize(vViewPosition), normalize(normal));
    float stripe = sin(26.0 * asin(clamp(mirrored.y, -1.0, 1.0)));
    float blur = fwidth(stripe) + 0.02;
    outgoingLight = mix(vec3(0.035), vec3(0.92), smoothstep(-blur, blur, stripe));
  }
  #include <opaque_fragment>
`;

/**
 * Add stripes to a material.
 * @param {import('../vendor/three/three.module.min.js').Material} material
 * @returns {{value: number}} 1 while it does, 0 else
 */
export function withZebra(material) {
  const zebra = { value: 0 };
  material.onBeforeCompile = (shader) => {
    shader.uniforms.zebra = zebra;
    shader.fragmentShader = `uniform float zebra;\n${shader.fragmentShader.replace('#include <opaque_fragment>', STRIPES)}`;
  };
  return zebra;
}
